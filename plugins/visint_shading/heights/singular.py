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
    found = np.zeros(int(group.max(initial=0)) + 1, np.int8)
    for number in range(1, found.size):
        rows, columns = np.nonzero(group == number)
        found[number] = _bend(labels, slopes, (float(np.median(rows)), float(np.median(columns))), reach)
    return found


def _bend(labels: Array, slopes: Array, middle: tuple[float, float], reach: float) -> int:
    y, x = middle
    top, left = max(0, int(y - reach)), max(0, int(x - reach))
    box = np.s_[top : int(y + reach) + 2, left : int(x + reach) + 2]
    near = labels[box] == labels[int(y), int(x)]
    near &= np.isfinite(slopes[box]).all(axis=-1)
    if near.sum() < 12:
        return 0
    rows, columns = np.nonzero(near)
    places = np.column_stack([columns - columns.mean(), rows - rows.mean(), np.ones(rows.size)])
    changes, *_ = np.linalg.lstsq(places, slopes[box][near].astype(np.float64), rcond=None)
    small, large = sorted(np.linalg.eigvalsh((changes[:2] + changes[:2].T) / 2), key=abs)
    if small * large < 0 and abs(small) > 0.2 * abs(large):
        return 0
    return int(np.sign(large))
