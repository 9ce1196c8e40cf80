"""A tree of boxes over triangles, so that a ray looks at few of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["BoxTree", "box_tree"]

LEAF = 4


class BoxTree(NamedTuple):
    """A balanced binary tree in one array; ``order`` says how the triangles have to be sorted.

    ``bounds`` float64 (N, 6): low then high corner. ``links`` int64 (N, 2): the two children, or, in a leaf,
    the first triangle and minus their count.
    """

    order: NDArray[np.int64]
    bounds: NDArray[np.float64]
    links: NDArray[np.int64]


def box_tree(corners: NDArray[np.float64]) -> BoxTree:
    """The tree over triangles (T, 3, 3), neighbours in space being neighbours along a Morton curve."""
    order = np.argsort(_morton(corners.mean(axis=1)), kind="stable")
    leaves = max(1, -(-len(corners) // LEAF))
    wide = 1 << (leaves - 1).bit_length()
    firsts = np.minimum(np.arange(wide) * len(corners) // wide, len(corners) - 1)
    counts = np.maximum(np.diff(np.append(firsts, len(corners))), 1)
    low = np.minimum.reduceat(corners[order].min(axis=1), firsts)
    high = np.maximum.reduceat(corners[order].max(axis=1), firsts)
    bounds = [np.hstack([low, high])]
    while len(bounds[0]) > 1:
        children = bounds[0]
        low = np.minimum(children[0::2, :3], children[1::2, :3])
        high = np.maximum(children[0::2, 3:], children[1::2, 3:])
        bounds.insert(0, np.hstack([low, high]))
    inner = np.arange(wide - 1)
    links = np.vstack([np.stack([2 * inner + 1, 2 * inner + 2], 1), np.stack([firsts, -counts], 1)])
    return BoxTree(order, np.ascontiguousarray(np.vstack(bounds)), links.astype(np.int64))


def _morton(points: NDArray[np.float64]) -> NDArray[np.int64]:
    low, high = points.min(axis=0), points.max(axis=0)
    cells = ((points - low) / np.maximum(high - low, 1e-12) * 1023).astype(np.int64)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code
