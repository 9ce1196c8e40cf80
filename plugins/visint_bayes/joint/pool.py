"""The candidates: minima of one energy under different trust in stereo and in brightness."""

from __future__ import annotations

from dataclasses import dataclass

from visint.arrays import Array
from visint_bayes.joint.energy import Recipe, Setting, minimum
from visint_bayes.joint.reflectance import Reflectance
from visint_bayes.joint.setting import Pair, brightened, setting_of, with_cuts

__all__ = ["NAMES", "RECIPES", "Pool", "candidates"]

RECIPES = {
    "plate": Recipe(0.03),
    "whole": Recipe(0.003, 0.1, turns=3),
    "loose": Recipe(0.003, turns=3),
    "shaded": Recipe(0.003, 0.1, turns=3),
    "bright": Recipe(0.003, 1.0, turns=3),
    "round": Recipe(0.003, 1.0, slant=4.0, turns=3),
}
"""From stereo and smoothness alone to full belief in brightness; the first two without cuts."""
NAMES = tuple(RECIPES)
TEXTURED = 0.3
"""Log brightness that spreads more about one albedo is texture: its edges are no depth edges."""


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
    setting, found = brightened(setting, pair, noise, first, amplitude)
    if setting.unseen.any():
        first = minimum(setting, RECIPES["plate"], first)
    cut, begin = setting, first
    if found is None or (len(found.albedo) == 1 and found.misfit < TEXTURED):
        cut, begin = with_cuts(setting, pair, noise, first)
    surfaces = {"plate": first, "loose": minimum(cut, RECIPES["loose"], begin)}
    if setting.brightness is not None:
        surfaces |= _shaded(cut, begin)
        uncut = cut is setting
        surfaces["whole"] = surfaces["shaded"] if uncut else minimum(setting, RECIPES["whole"], first)
    return Pool({name: surfaces[name] for name in NAMES if name in surfaces}, cut, found, noise)


def _shaded(setting: Setting, start: Array) -> dict[str, Array]:
    """The candidates that believe brightness, each from the one that believes it less."""
    shaded = minimum(setting, RECIPES["shaded"], start)
    bright = minimum(setting, RECIPES["bright"], shaded)
    return {"shaded": shaded, "bright": bright, "round": minimum(setting, RECIPES["round"], bright)}
