"""A view as shading sees it: even brightness inside regions, and what was evened out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_shading.brightness.evening import evened_inside, gain
from visint_shading.brightness.noise import noise_of
from visint_shading.brightness.patches import patches

__all__ = ["Seen", "seen"]

SATURATED = 0.995


class Seen(NamedTuple):
    """Brightness inside regions.

    ``labels``: int32 (H, W), 0 where nothing is said. ``even``: float32 (H, W), brightness freed from noise,
    NaN at label 0. ``noise``: its standard deviation in the image; ``spread``: what is left of it in ``even``;
    ``length``: the window's standard deviation, pixels.
    """

    labels: Array
    even: Array
    noise: float
    spread: float
    length: float

    @property
    def regions(self) -> int:
        """The largest label."""
        return int(self.labels.max(initial=0))


def seen(image: Array, usable: Array, regions: Array | None, boundaries: Array | None, span: float) -> Seen:
    """``image`` float32 (H, W) inside its regions, where it is ``usable`` (bool).

    The noisier the image, the wider the mean. ``span`` scales it: 1 suits images about 256 pixels wide.
    What is hardly brighter than noise, or saturated, gets label 0.
    """
    noise = noise_of(image)
    with np.errstate(invalid="ignore"):
        known = usable & (image < SATURATED)
    labels = patches(known, regions, boundaries)
    length = 0.0 if noise < 1e-3 else (0.7 + 28 * noise) * span
    even = evened_inside(image, labels, length)
    left = noise * gain(length)
    with np.errstate(invalid="ignore"):
        bright = even > 0.02 + noise
    even[~bright] = np.nan
    return Seen(labels * bright, even, noise, left, length)
