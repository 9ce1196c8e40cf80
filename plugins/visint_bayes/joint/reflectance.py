"""What the surface reflects: one albedo or a few, and where a highlight hides it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Reflectance", "reflectance"]

APART = 1.45
"""Albedos closer than this ratio are one."""
LEAST = 0.12
"""A class of albedo has at least this part of the pixels."""
TOO_SPREAD = 0.3
"""Log albedo that spreads more about its classes holds more of them."""
STEP = 0.02
"""Bin of the histogram of log albedo."""


class Reflectance(NamedTuple):
    """``albedo`` of each class, ascending; ``labels`` int32 (H, W), 0 where unknown; ``shine`` bool (H, W).

    ``misfit``: robust standard deviation of log brightness against it.
    """

    albedo: Array
    labels: Array
    shine: Array
    misfit: float


def reflectance(brightness: Array, cosine: Array, mask: Array, noise: float, zoom: float) -> Reflectance:
    """The classes of albedo that brightness over n·l falls into.

    Parameters
    ----------
    brightness, cosine
        float32 (H, W): smoothed brightness, and n·l of a surface that is about right.
    mask
        bool (H, W): where to look.
    noise
        Standard deviation of the smoothed brightness.
    zoom
        Size of the object's image, 1 being that of one at 256 pixels; highlights are widened with it.
    """
    sure = mask & (cosine > 0.35) & (brightness > 4 * noise + 0.01)
    if sure.sum() < 30:
        level = float(np.percentile(brightness[mask], 99)) if mask.any() else 1.0
        return Reflectance(np.array([max(level, 1e-3)]), mask.astype(np.int32), np.zeros_like(mask), np.inf)
    ratio = np.log(brightness[sure] / cosine[sure])
    levels = _modes(ratio, 1 / (1 - np.minimum(cosine[sure], 1) ** 2 + 0.05))
    levels = _matte(levels, ratio, cosine[sure])
    if _spread(ratio, levels) > TOO_SPREAD:
        levels = _halves(ratio)
    albedo = np.exp(levels)
    labels = _labels(brightness, cosine, mask, levels)
    shine = np.zeros_like(mask)
    if len(albedo) == 1:
        shine = _widened(mask & (brightness > 1.04 * albedo[0] + 3 * noise), 4 * zoom) & mask
    return Reflectance(albedo, labels, shine, _spread(ratio, levels))


def _spread(ratio: Array, levels: Array) -> float:
    """Robust standard deviation of log albedo about the nearest class."""
    return float(1.4826 * np.median(np.abs(ratio[:, None] - levels).min(axis=1)))


def _halves(ratio: Array) -> Array:
    """Two classes where the histogram shows no valley: the two means that spread least (Lloyd)."""
    levels = np.percentile(ratio, [20, 80])
    for _ in range(12):
        upper = ratio > levels.mean()
        if upper.all() or not upper.any():
            break
        levels = np.array([np.median(ratio[~upper]), np.median(ratio[upper])])
    return np.asarray(levels)


def _modes(ratio: Array, weight: Array) -> Array:
    """Peaks of the weighted histogram, ascending; those that stand well apart from each other."""
    from scipy.ndimage import gaussian_filter1d

    low = float(np.percentile(ratio, 0.5)) - 0.2
    bins = np.clip(((ratio - low) / STEP).astype(int), 0, 400)
    density = gaussian_filter1d(np.bincount(bins, weight, 410).astype(float), 3.0)
    order = np.argsort(-density)
    found: list[int] = []
    for place in order[: (density > 0.12 * density.max()).sum()]:
        peak = density[place] >= density[max(place - 1, 0) : place + 2].max()
        if peak and all(_apart(density, int(place), other) for other in found):
            found.append(int(place))
        if len(found) == 3:
            break
    return np.asarray(low + STEP * (np.sort(np.array(found)) + 0.5))


def _matte(levels: Array, ratio: Array, cosine: Array) -> Array:
    """Without classes of few pixels, and without those only where the surface faces the light: highlights."""
    nearest = np.abs(ratio[:, None] - levels).argmin(axis=1)
    keep = []
    for k in range(len(levels)):
        mine = cosine[nearest == k]
        steep = k == 0 or (mine.size > 0 and float(np.percentile(mine, 10)) < 0.85)
        keep.append(mine.size > LEAST * ratio.size and steep)
    return np.asarray(levels[np.array(keep)] if any(keep) else levels[-1:])


def _apart(density: Array, place: int, other: int) -> bool:
    low, high = min(place, other), max(place, other)
    valley = density[low : high + 1].min()
    return bool((high - low) * STEP > np.log(APART) and valley < 0.6 * min(density[low], density[high]))


def _labels(brightness: Array, cosine: Array, mask: Array, levels: Array) -> Array:
    """The nearest class, calmed; 0 next to where classes meet."""
    import cv2

    if len(levels) == 1:
        return mask.astype(np.int32)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.log(np.maximum(brightness, 1e-4) / np.clip(cosine, 0.05, 1))
    nearest = np.abs(ratio[..., None] - levels).argmin(axis=-1).astype(np.uint8) + 1
    calm = cv2.medianBlur(nearest, 5)
    edge = cv2.morphologyEx(calm, cv2.MORPH_GRADIENT, np.ones((5, 5), np.uint8)) > 0
    return np.where(mask & ~edge, calm, 0).astype(np.int32)


def _widened(mask: Array, reach: float) -> Array:
    import cv2

    size = 2 * round(reach) + 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    return np.asarray(
        cv2.dilate(cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)), kernel)
        > 0
    )
