"""Patches: the parts of the lattice that are separate problems."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from visint.arrays import Array
from visint_texture.surface.sites import Sites

__all__ = ["Box", "patches"]

Box = tuple[slice, slice]
FEWEST = 12
"""Sites that a patch needs, with texture."""


def patches(sites: Sites, regions: Array | None, most: int) -> Iterator[tuple[Box, Array]]:
    """The largest ``most`` patches: each one's box on the lattice and which sites of it belong.

    ``regions`` is int (H, W), 0 a boundary; a site belongs to the region at its middle. Without regions, and
    within each, a patch is connected texture.
    """
    labels = _labels(sites, regions)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    for label in np.argsort(-sizes, kind="stable")[:most]:
        if sizes[label] < FEWEST:
            return
        rows, columns = np.nonzero(labels == label)
        box = (slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1))
        yield box, labels[box] == label


def _labels(sites: Sites, regions: Array | None) -> Array:
    """int (R, C): connected patches from 1, numbered so that equal inputs give equal labels."""
    from scipy.ndimage import label

    textured = sites.weight > 0.1
    if regions is None:
        labels, _ = label(textured)
        return np.asarray(labels)
    of_sites = _at_sites(regions, sites.shape)
    labels, count = np.zeros(sites.shape, np.int64), 0
    for region in np.unique(of_sites[textured & (of_sites > 0)]):
        found, more = label(textured & (of_sites == region))
        labels = np.where(found > 0, found + count, labels)
        count += more
    return np.asarray(labels)


def _at_sites(regions: Array, shape: tuple[int, int]) -> Array:
    rows = ((np.arange(shape[0]) + 0.5) * regions.shape[0] / shape[0]).astype(int)
    columns = ((np.arange(shape[1]) + 0.5) * regions.shape[1] / shape[1]).astype(int)
    return np.asarray(regions[rows[:, None], columns[None, :]])
