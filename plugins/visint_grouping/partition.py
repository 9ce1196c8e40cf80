"""Partitions of an image: every pixel belongs to a region, and arcs of cracks run between regions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields.resampling import region_boundaries

__all__ = ["Arcs", "arcs_of", "complete", "numbered", "regions_between", "separated", "united"]


class Arcs(NamedTuple):
    """One row an arc between the regions ``first < second``: cracks along it and sums over them, (N, C)."""

    first: Array
    second: Array
    length: Array
    sums: Array


def arcs_of(labels: Array, summed: Sequence[tuple[Array, Array]] = (), *, signed: int = 0) -> Arcs:
    """The arcs between 4-connected neighbours of ``labels`` (integers (H, W) from 0).

    ``summed``: what to sum along them, each as float (H, W - 1) for the cracks between a pixel and its right
    neighbour and (H - 1, W) for those below it. The first ``signed`` change sign with the arc's direction.
    """
    across, down = labels[:, :-1] != labels[:, 1:], labels[:-1] != labels[1:]
    one = np.concatenate([labels[:, :-1][across], labels[:-1][down]]).astype(np.int64)
    other = np.concatenate([labels[:, 1:][across], labels[1:][down]]).astype(np.int64)
    low, high = np.minimum(one, other), np.maximum(one, other)
    span = int(labels.max(initial=0)) + 1
    keys, which = np.unique(low * span + high, return_inverse=True)
    turned = np.where(one > other, -1.0, 1.0)
    sums = np.zeros((len(keys), len(summed)))
    for j, (right, lower) in enumerate(summed):
        along = np.concatenate([right[across], lower[down]])
        sums[:, j] = np.bincount(which, along * turned if j < signed else along, len(keys))
    length = np.bincount(which, minlength=len(keys)).astype(np.float64)
    return Arcs(keys // span, keys % span, length, sums)


def numbered(labels: Array) -> tuple[Array, int]:
    """``labels`` (integers ≥ 0) renumbered without gaps from 0, int32, and how many there are."""
    used = np.zeros(int(labels.max(initial=0)) + 1, dtype=bool)
    used[labels] = True
    return (np.cumsum(used, dtype=np.int32) - 1)[labels], int(used.sum())


def united(labels: Array, home: Array) -> tuple[Array, int]:
    """``labels`` after each region became part of ``home`` (R), numbered from 0, and how many are left."""
    fresh, count = numbered(home)
    return fresh[labels], count


def regions_between(boundaries: Array) -> Array:
    """int32 (H, W): 4-connected regions between ``boundaries`` (bool) from 1, 0 on them: as the map derives."""
    import cv2

    _, labels = cv2.connectedComponents((~boundaries).astype(np.uint8), connectivity=4)
    return np.asarray(labels, dtype=np.int32)


def complete(regions: Array) -> Array:
    """``regions`` (int32, 0 unknown) with the label of the nearest region wherever there is none.

    Where there is no region at all, all pixels are one region.
    """
    import cv2

    if regions.all():
        return regions
    if not regions.any():
        return np.ones_like(regions)
    _, nearest = cv2.distanceTransformWithLabels(
        (regions == 0).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    name = np.zeros(int(nearest.max()) + 1, np.int32)
    known = regions > 0
    name[nearest[known]] = regions[known]
    return np.asarray(name[nearest])


def separated(labels: Array) -> tuple[Array, Array]:
    """(boundaries, regions) of a partition: its outlines, bool, and its labels, int32 from 1, 0 on outlines.

    Two regions never touch: of two neighbours with different labels one is an outline.
    """
    names = numbered(labels)[0] + 1
    boundaries = region_boundaries(names)
    return boundaries, np.where(boundaries, np.int32(0), names)
