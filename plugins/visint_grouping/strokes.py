"""Strokes: thin lines as arcs of pixels, with their ends, directions and corners."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Sites", "Strokes", "sites", "stroked", "thinned"]

NEAR, FAR = 1, 9
"""A direction at an end is that of the chord between its pixels number NEAR and FAR."""
ARM, SHARP = 6, 0.7
"""Corners: pixels on either side, and the turn (radians) that counts."""


class Strokes(NamedTuple):
    """``arc``: int32 (H, W), number of the arc through a pixel from 1; pixels in order, arc by arc."""

    arc: Array
    rows: Array
    columns: Array
    starts: Array


class Sites(NamedTuple):
    """Terminations first (``ends`` of them), then corners.

    ``place``: float64 (N, 2), row and column; ``way``: (N, 2) unit vector along which a line would go on, zero
    for corners; ``arc``: the arc it belongs to; ``length``: its pixels.
    """

    place: Array
    way: Array
    arc: Array
    length: Array
    ends: int


def thinned(lines: Array) -> Array:
    """Bool (H, W): ``lines`` one pixel wide, with the same ends and the same regions between them."""
    from visint_grouping.lines import _kernels

    thin = lines.copy()
    _kernels.thin(thin)
    return thin


def stroked(lines: Array) -> Strokes:
    """The arcs of thin ``lines`` (bool (H, W))."""
    from visint_grouping.lines import _kernels

    total = int(lines.sum())
    arc = np.zeros(lines.shape, np.int32)
    rows, columns, starts = (np.zeros(total + extra, np.int64) for extra in (0, 0, 1))
    count = _kernels.trace(lines, arc, rows, columns, starts)
    return Strokes(arc, rows, columns, starts[: count + 1])


def sites(lines: Array, strokes: Strokes) -> Sites:
    """Where a link may begin or end: terminations of arcs (pixels with one neighbour), and corners."""
    import cv2

    from visint_grouping.lines import _kernels

    around = cv2.filter2D(lines.astype(np.uint8), -1, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_CONSTANT)
    first, last = strokes.starts[:-1], strokes.starts[1:] - 1
    length = last - first + 1
    order = np.concatenate([first, last])
    inner = np.concatenate([first + np.minimum(FAR, length - 1), last - np.minimum(FAR, length - 1)])
    outer = np.concatenate([first + np.minimum(NEAR, length - 1), last - np.minimum(NEAR, length - 1)])
    free = around[strokes.rows[order], strokes.columns[order]] <= 2
    free &= np.concatenate([length, length]) > 2
    points = np.stack([strokes.rows, strokes.columns], axis=1).astype(np.float64)
    way = points[outer] - points[inner]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    strength = np.zeros(len(points))
    _kernels.corners(strokes.rows, strokes.columns, strokes.starts, ARM, SHARP, strength)
    bent = np.flatnonzero(strength)
    which = np.concatenate([order[free], bent])
    arc = strokes.arc[strokes.rows[which], strokes.columns[which]]
    ways = np.concatenate([way[free], np.zeros((len(bent), 2))])
    return Sites(points[which], ways, arc, length[arc - 1].astype(np.float64), int(free.sum()))
