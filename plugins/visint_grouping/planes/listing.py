"""Regions as lists of pixels, with their neighbours."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_grouping.partition import arcs_of

__all__ = ["Listing", "Neighbours", "listing_of", "neighbours_of"]


class Listing(NamedTuple):
    """Pixels (row << 20 | column) region by region: those of r are ``order[starts[r]:starts[r + 1]]``."""

    starts: Array
    order: Array

    @property
    def areas(self) -> Array:
        """Pixels of each region."""
        return np.diff(self.starts)


class Neighbours(NamedTuple):
    """Of region r: ``neighbour[begins[r]:begins[r + 1]]``, with as many ``lengths`` of common outline."""

    begins: Array
    neighbour: Array
    lengths: Array


def listing_of(labels: Array, count: int) -> Listing:
    """The pixels of each of ``count`` regions; labels int32 (H, W) from 0."""
    from visint_grouping.planes import _kernels

    starts, order = np.zeros(count + 1, np.int64), np.empty(labels.size, np.int64)
    _kernels.listed(labels, starts, order)
    return Listing(starts, order)


def neighbours_of(labels: Array, count: int) -> Neighbours:
    """Who borders on whom, and how long."""
    arcs = arcs_of(labels)
    one = np.concatenate([arcs.first, arcs.second])
    other = np.concatenate([arcs.second, arcs.first])
    by_region = np.argsort(one, kind="stable")
    begins = np.concatenate([[0], np.cumsum(np.bincount(one, minlength=count))]).astype(np.int64)
    return Neighbours(begins, other[by_region].astype(np.int32), np.tile(arcs.length, 2)[by_region])
