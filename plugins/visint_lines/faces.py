"""Which regions are flat: a plane has no limb, however low the angle at which it is seen."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_lines.sections import Surfaces

__all__ = ["flat_faces"]

FEWEST = 24
"""Pixels of a region below which nothing is said."""
EXACT, ROUGH = 0.1, 3.0
"""Error of the plane, pixels of depth, up to which a region is flat anyway, and beyond which it never is."""
BETTER = 1.3
"""By how much smaller the error of a curved surface must be to say that the region is not flat."""


def flat_faces(seen: Surfaces) -> Array:
    """bool (L,), by label: whether a plane explains 1/Z in the region as well as a quadratic surface does.

    Errors are in pixels of relative depth, f Δw/w.
    """
    labels = seen.labels.ravel()
    nearness = seen.planes[..., 0].ravel()
    order = np.argsort(labels, kind="stable")
    known = order[np.isfinite(nearness[order])]
    flat = np.zeros(int(labels.max(initial=0)) + 1, dtype=bool)
    width = seen.labels.shape[1]
    for mine in np.split(known, np.flatnonzero(np.diff(labels[known])) + 1):
        if len(mine) >= FEWEST:
            depth = seen.camera.focal_length * nearness[mine] / nearness[mine].mean()
            flat[labels[mine[0]]] = _is_flat(mine % width, mine // width, depth)
    return flat


def _is_flat(column: Array, row: Array, depth: Array) -> bool:
    x, y = column - column.mean(), row - row.mean()
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    plane, curved = _off(terms[:, :3], depth), _off(terms, depth)
    return plane < EXACT or (plane < ROUGH and plane < BETTER * curved)


def _off(terms: Array, value: Array) -> float:
    """Root mean square of what is left of ``value``."""
    scaled = terms / np.maximum(np.abs(terms).max(axis=0), 1e-9)
    return float(np.sqrt(np.mean((value - scaled @ np.linalg.lstsq(scaled, value, rcond=None)[0]) ** 2)))
