"""Gestalt: what it costs to link two sites, Eq. 5.20 as a cost, and the coherence that follows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_grouping.strokes import Sites

__all__ = ["Weights", "coherence", "costs", "voronoi_neighbours"]

MOST_LEVELS = 255.0
"""M of the brightness term: how many grey levels there are."""
LEAST = 1e-3
"""ε: where there is no contrast at all the brightness term is beyond any threshold."""
STEP = 0.1
"""ε of the depth term, in parts of the depth range: a step of that much halves it."""
FLANK = 3.0
"""How far beside a link brightness and depth are compared, pixels."""
SAMPLES = 16


class Weights(NamedTuple):
    """How much each of the five counts; 0 leaves one out."""

    proximity: float
    curvilinearity: float
    cotermination: float
    brightness: float
    depth: float


def voronoi_neighbours(place: Array) -> Array:
    """int64 (N, 2): pairs of ``place`` (M, 2) whose Voronoi cells touch; all pairs of up to three."""
    from scipy.spatial import Delaunay, QhullError

    count = len(place)
    if count < 4:
        return np.array([(i, j) for i in range(count) for j in range(i + 1, count)], np.int64).reshape(-1, 2)
    try:
        triangles = Delaunay(place).simplices
    except QhullError:  # all on one line: neighbours are neighbours along it
        order = np.lexsort((place[:, 0], place[:, 1]))
        return np.sort(np.stack([order[:-1], order[1:]], axis=1), axis=1)
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1)
    return np.unique(sides, axis=0).astype(np.int64)


def costs(sites: Sites, pairs: Array, weights: Weights, shade: Array, depth: Array | None) -> Array:
    """float64 (N): E of Eq. 5.20 for each of ``pairs`` (int64 (N, 2) into ``sites``).

    Parameters
    ----------
    shade
        float32 (H, W): grey levels, the mean of the region of each pixel.
    depth
        float32 (H, W), NaN unknown; None leaves the term out.
    """
    here, there = pairs.T
    gap = sites.place[there] - sites.place[here]
    distance = np.maximum(np.linalg.norm(gap, axis=1), 1e-9)
    along = gap / distance[:, None]
    neighbours = np.bincount(pairs.ravel(), minlength=len(sites.place))
    proximity = distance**2 / (sites.length[here] * sites.length[there])
    curve = (_angle(sites.way[here], along) + _angle(sites.way[there], -along)) / (2 * np.pi)
    shared = 2 / (neighbours[here] + neighbours[there])
    contrast = _across(shade, sites.place[here], gap, along)
    total = weights.proximity * proximity + weights.curvilinearity * curve + weights.cotermination * shared
    total += weights.brightness * MOST_LEVELS / np.maximum(contrast, LEAST)
    if depth is not None:
        step = _across(depth, sites.place[here], gap, along) / _range(depth)
        total += weights.depth * STEP / (STEP + step)
    return np.asarray(total)


def coherence(cost: Array, weights: Weights, *, with_depth: bool) -> Array:
    """β = 1/(1 + E/Σw), the corrected Eq. 5.21: 1 for a link that costs nothing, ½ for one that costs Σw."""
    total = sum(weights) - (0.0 if with_depth else weights.depth)
    return np.asarray(1 / (1 + cost / max(total, 1e-9)))


def _angle(way: Array, along: Array) -> Array:
    """Radians between where a line would go on and where the link goes; 0 at a corner, which points nowhere."""
    cosine = np.clip((way * along).sum(axis=1), -1, 1)
    return np.where(way.any(axis=1), np.arccos(cosine), 0.0)


def _across(field: Array, start: Array, gap: Array, along: Array) -> Array:
    """float64 (N): mean absolute difference of ``field`` between both sides of links, known ones alone."""
    share = np.linspace(0, 1, SAMPLES)
    points = start[:, None] + share[None, :, None] * gap[:, None]
    aside = FLANK * np.stack([-along[:, 1], along[:, 0]], axis=1)[:, None]
    difference = np.abs(_at(field, points + aside) - _at(field, points - aside)).astype(np.float64)
    known = np.isfinite(difference)
    return np.asarray(np.where(known, difference, 0).sum(axis=1) / np.maximum(known.sum(axis=1), 1))


def _at(field: Array, points: Array) -> Array:
    """Values at the nearest pixels of ``points`` (…, 2), row and column; outside the nearest inside."""
    rows, columns = field.shape
    row = np.clip(np.rint(points[..., 0]).astype(np.int64), 0, rows - 1)
    column = np.clip(np.rint(points[..., 1]).astype(np.int64), 0, columns - 1)
    return np.asarray(field[row, column])


def _range(depth: Array) -> float:
    known = depth[np.isfinite(depth)]
    if not known.size:
        return 1.0
    low, high = np.percentile(known, (5, 95))
    return max(float(high - low), 1e-6 * max(abs(float(high)), 1e-6))
