"""Singular points: where a surface faces the light, the only places at which its height is anybody's guess."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_shading.reflectance.albedo import percentile_by_region

__all__ = ["Singular", "bends_of", "singular_points"]

NEAR_ONE = 0.97


class Singular(NamedTuple):
    """Groups of adjacent singular points: ``group`` int32 (H, W), 0 elsewhere; ``label`` of the region of each.

    Index 0 of the per-group arrays is unused. ``bend`` is +1 convex, −1 concave, 0 a saddle; ``height`` what is
    known of ln Z − w₀ there.
    """

    group: Array
    label: Array
    bend: Array
    height: Array


def singular_points(cosine: Array, sigma: Array, labels: Array) -> tuple[Array, Array]:
    """Groups (H, W) of pixels that face the light as far as noise lets one see, and their regions' labels.

    A pixel counts if its cosine lies within 1.5 ``sigma`` (or 0.4 %, 5°) of its region's largest, and that is
    near 1 (0.97: albedo may be 3 % off). Small groups beside a large one of the same region, which noise makes,
    are left out.
    """
    import cv2

    with np.errstate(invalid="ignore"):
        largest = percentile_by_region(np.where(labels > 0, cosine, 0), labels, 0.998)
        start = np.where(largest > NEAR_ONE, largest, 2.0)[labels]
        facing = (labels > 0) & (cosine >= start - np.maximum(0.004, 1.5 * sigma))
    count, group = cv2.connectedComponents(facing.astype(np.uint8), connectivity=8)
    group = np.asarray(group, np.int32)
    size = np.bincount(group.ravel(), minlength=count)
    label = np.zeros(count, np.int64)
    label[group.ravel()] = labels.ravel()
    widest = np.zeros(int(labels.max(initial=0)) + 1)
    np.maximum.at(widest, label[1:], size[1:])
    keep = np.zeros(count, bool)
    keep[1:] = size[1:] >= 0.2 * widest[label[1:]]
    number = np.cumsum(keep) * keep
    return number[group].astype(np.int32), np.concatenate([[0], label[keep]])


def bends_of(group: Array, labels: Array, slopes: Array, reach: float) -> Array:
    """+1 convex, −1 concave, 0 a saddle or unknown, by group: int8 (G + 1,).

    From how ``slopes`` (H, W, 2) of ln Z − w₀ change around each group, within ``reach`` pixels of its middle
    and in its region. A principal bend below a fifth of the other counts as none (a cylinder).
    """
    from visint_shading.heights import _kernels

    middles = _middles(group)
    sums = np.empty((len(middles), 10))
    _kernels.bends(labels, slopes, middles, float(reach), sums)
    spread = sums[:, [3, 4, 4, 5]].reshape(-1, 2, 2)
    changes = np.linalg.pinv(spread, hermitian=True) @ sums[:, [6, 8, 7, 9]].reshape(-1, 2, 2)
    principal = np.linalg.eigvalsh((changes + changes.swapaxes(1, 2)) / 2)
    low, high = np.abs(principal).min(axis=1), np.abs(principal).max(axis=1)
    saddle = (principal[:, 0] * principal[:, 1] < 0) & (low > 0.2 * high)
    larger = np.where(np.abs(principal[:, 1]) >= np.abs(principal[:, 0]), principal[:, 1], principal[:, 0])
    bend = np.where(saddle | (sums[:, 0] < 12), 0, np.sign(larger))
    return np.concatenate([[0], bend]).astype(np.int8)


def _middles(group: Array) -> Array:
    """Median row and column of each group, float64 (G, 2)."""
    places = np.nonzero(group)
    number = group[places]
    size = np.bincount(number, minlength=1)[1:]
    start = np.cumsum(size) - size
    sides = (place[np.lexsort((place, number))] for place in places)
    return np.column_stack([(side[start + (size - 1) // 2] + side[start + size // 2]) / 2 for side in sides])
