"""The cracks of a label map as curves: lines between pixels of different regions, closed by construction."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Chain", "background_of", "chains_of", "whole"]


class Chain(NamedTuple):
    """A curve between two regions: points (N, 2) as column and row, and the regions on either hand."""

    points: Array
    closed: bool
    left: int
    right: int


def whole(regions: Array, smallest: float) -> Array:
    """int32 (H, W): ``regions`` with no pixel unlabelled, and no piece of less than ``smallest`` pixels.

    Boundary pixels (0) and specks go to the nearest region. Pieces of one label apart from each other stay one
    label: background seen through a ring is background.
    """
    from visint_lines import _kernels

    labels = np.ascontiguousarray(regions, dtype=np.int32)
    pieces = _kernels.components(labels)
    area = np.bincount(pieces.ravel())
    keep = (area >= smallest)[pieces] & (labels > 0)
    if not keep.any():
        keep = labels > 0
    return _nearest(labels, keep)


def _nearest(labels: Array, keep: Array) -> Array:
    from scipy.ndimage import distance_transform_edt

    if keep.all():
        return labels
    if not keep.any():
        return np.ones_like(labels)
    nearest = distance_transform_edt(~keep, return_distances=False, return_indices=True)
    return np.ascontiguousarray(labels[tuple(nearest)])


def chains_of(labels: Array) -> list[Chain]:
    """Every curve between two regions of a whole label map."""
    from visint_lines import _kernels

    points, first, closed, sides = _kernels.chains(labels, _kernels.cracks(labels))
    places = points[:, ::-1] - 0.5
    return [
        Chain(places[first[i] : first[i + 1]], bool(closed[i]), int(sides[i, 0]), int(sides[i, 1]))
        for i in range(len(closed))
    ]


def background_of(labels: Array) -> int:
    """The region that holds at least half of the image's frame; 0 if none does."""
    frame = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    values, counts = np.unique(frame, return_counts=True)
    most = int(counts.argmax())
    return int(values[most]) if 2 * counts[most] >= counts.sum() else 0
