"""The brightness that segmentations compare: grey levels in which noise is about the same everywhere."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Brightness", "graded"]

LEVELS = 255.0
BINS = 8
ENOUGH = 30000
"""Pixels that noise is measured on, about; more only cost time."""


class Brightness(NamedTuple):
    """``levels``: float32 (H, W) in 0..255; ``noise``: standard deviation of its white noise, grey levels."""

    levels: Array
    noise: float


def graded(image: Array) -> Brightness:
    """``image`` (float32 (H, W), linear in [0, 1]) as grey levels of even noise.

    Noise of the same strength in dark and bright parts leaves intensity linear. Noise that grows with
    intensity to the power p, as a camera's does, is evened out by intensity^(1 - p) (Bartlett 1947,
    doi:10.2307/3001536), an exponent between 0.4 (about the curve of 8-bit files) and 1.
    """
    known = np.clip(np.nan_to_num(image, posinf=1.0), 0, 1).astype(np.float32)
    some = _every(known.shape)
    levels = np.float32(LEVELS) * known ** np.float32(_exponent(known[some], _roughness(known)[some]))
    return Brightness(levels, _spread(_roughness(levels)[some], (known[some] > 0) & (known[some] < 1)))


def _every(shape: tuple[int, int]) -> tuple[slice, slice]:
    """Every nth row and column: an even sample of about ``ENOUGH`` pixels."""
    step = max(round(np.sqrt(shape[0] * shape[1] / ENOUGH)), 1)
    return slice(None, None, step), slice(None, None, step)


def _roughness(image: Array) -> Array:
    """What a mask says that planes and edges along the axes do not excite (doi:10.1006/cviu.1996.0060)."""
    import cv2

    mask = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32) / 6
    return np.asarray(np.abs(cv2.filter2D(image, cv2.CV_32F, mask)))


def _spread(rough: Array, usable: Array) -> float:
    some = rough[usable]
    return float(np.median(some)) / 0.6745 if some.size else 0.0


def _exponent(known: Array, rough: Array) -> float:
    """1 - p, where noise grows like intensity^p: a line through the logarithms of quantiles' medians."""
    usable = (known > 0.02) & (known < 0.98)
    if usable.sum() < 64 * BINS:
        return 1.0
    values, noise = known[usable], rough[usable]
    cuts = np.quantile(values, np.linspace(0, 1, BINS + 1)[1:-1])
    which = np.searchsorted(cuts, values)
    centres, spreads = [], []
    for bin_ in range(BINS):
        inside = which == bin_
        if inside.sum() >= 32 and (spread := float(np.median(noise[inside]))) > 0:
            centres.append(np.log(values[inside].mean()))
            spreads.append(np.log(spread))
    if len(centres) < 3 or np.ptp(centres) < 0.3:
        return 1.0
    slope = float(np.polyfit(centres, spreads, 1)[0])
    return float(np.clip(1 - slope, 0.4, 1.0))
