"""Arcs painted into maps."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_lines.diagram import Diagram

__all__ = ["along", "pixels_of"]


def pixels_of(points: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """(rows, columns) of the pixels that a curve runs through; points half a pixel apart leave no gap."""
    finer = np.concatenate([points, (points[1:] + points[:-1]) / 2])
    column = np.clip(np.rint(finer[:, 0]).astype(np.int64), 0, size[1] - 1)
    row = np.clip(np.rint(finer[:, 1]).astype(np.int64), 0, size[0] - 1)
    return row, column


def along(diagram: Diagram, value: Array) -> Array:
    """(H, W): at each pixel of an arc its ``value`` (A,), 0 elsewhere; where arcs share a pixel the largest."""
    painted = np.zeros(diagram.size, dtype=value.dtype)
    for arc, own in zip(diagram.arcs, value, strict=True):
        row, column = pixels_of(arc.points, diagram.size)
        painted[row, column] = np.maximum(painted[row, column], own)
    return painted
