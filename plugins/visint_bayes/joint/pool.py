"""The candidates: minima of one energy under different trust in stereo and in brightness."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from visint.arrays import Array
from visint_bayes.joint.energy import Recipe, Setting, minimum
from visint_bayes.joint.reflectance import Reflectance
from visint_bayes.joint.setting import Pair, brightened, setting_of

__all__ = ["NAMES", "RECIPES", "Pool", "candidates"]

RECIPES = {
    "plate": Recipe(0.03),
    "loose": Recipe(0.003),
    "faint": Recipe(0.02, 0.03),
    "shaded": Recipe(0.003, 0.1),
    "bright": Recipe(0.003, 1.0),
    "round": Recipe(0.003, 1.0, slant=4.0),
}
"""From stereo and smoothness alone to full belief in brightness."""
NAMES = tuple(RECIPES)
FROM = {"loose": "plate", "faint": "plate", "shaded": "faint", "bright": "shaded", "round": "bright"}
"""Where the search for each begins."""


@dataclass(frozen=True, slots=True)
class Pool:
    """Surfaces by name, float64 (H, W) px, the setting they come from, the reflectance and the noise found."""

    surfaces: dict[str, Array]
    setting: Setting
    reflectance: Reflectance | None
    noise: float


def candidates(pair: Pair, amplitude: float = 1.0) -> Pool:
    """The minima; those that brightness takes part in only with a light and an ``amplitude`` that is not 0."""
    setting, noise = setting_of(pair)
    first = minimum(setting, RECIPES["plate"])
    setting, found = brightened(setting, pair, noise, first)
    surfaces = {"plate": first}
    if found is not None and setting.unseen.any():
        surfaces["plate"] = minimum(setting, RECIPES["plate"], first)
    for name in NAMES[1:]:
        recipe = RECIPES[name]
        if recipe.shading > 0 and (found is None or amplitude == 0):
            continue
        recipe = replace(recipe, shading=recipe.shading * amplitude, turns=3)
        surfaces[name] = minimum(setting, recipe, surfaces[FROM[name]])
    return Pool(surfaces, setting, found, noise)


def median_of(pool: Pool) -> Array:
    """The candidates' median, pixel by pixel."""
    return np.asarray(np.median(np.stack(list(pool.surfaces.values())), axis=0))
