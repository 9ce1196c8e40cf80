"""Depth across an arc: the gap and the angle at it, extrapolated from both sides."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Profile", "profile"]

LEAST = 2
"""Samples on a side below which it is not known."""
STEEPEST = 5.0
"""Slope, pixels of depth a pixel, beyond which a face is seen edge-on."""
STIFF = 4.0
"""Weight against a bend that few samples would make up out of noise, pixels²."""


class Profile(NamedTuple):
    """What N sections say.

    ``gap``: by how many pixels the left side is nearer at the arc; ``dihedral``: radians, convex positive;
    ``steepness``: mean slope of the two sides at the arc, at most :data:`STEEPEST`;
    ``seen``: bool, both sides are known; ``alone``: 1 where the left side alone is, -1 the right, else 0.
    """

    gap: Array
    dihedral: Array
    steepness: Array
    seen: Array
    alone: Array


def profile(depth: Array, offset: Array, there: Array) -> Profile:
    """Fits ζ = a + b s + c s² to either side of each section, with its own a and b and one c for both.

    Parameters
    ----------
    depth
        float (N, 2, M), pixels, left then right; NaN is unknown.
    offset
        float (M,): distances from the arc, pixels.
    there
        bool (N, 2, M): the sample lies in its side's region, whether or not depth is known.
    """
    known = np.isfinite(depth)
    enough = known.sum(axis=2) >= LEAST
    seen = enough.all(axis=1)
    blank = (there.sum(axis=2) >= LEAST) & ~known.any(axis=2)
    alone = (enough[:, 0] & blank[:, 1]).astype(np.int64) - (enough[:, 1] & blank[:, 0])
    terms = _terms(offset)
    weight = (known & seen[:, None, None]).reshape(len(depth), len(terms)).astype(np.float64)
    value = np.where(known, depth, 0.0).reshape(len(depth), len(terms))
    normal = np.einsum("nk,ki,kj->nij", weight, terms, terms) + np.diag([1e-9, 1e-9, 1e-9, 1e-9, STIFF])
    right = np.einsum("nk,ki->ni", weight * value, terms)
    a_left, b_left, a_right, b_right, _ = np.linalg.solve(normal, right[..., None])[..., 0].T
    bend = np.arctan(b_right) - np.arctan(b_left)
    steep = np.minimum((np.abs(b_left) + np.abs(b_right)) / 2, STEEPEST)
    return Profile(a_right - a_left, bend, steep, seen, alone)


def _terms(offset: Array) -> Array:
    """(2 M, 5): what each sample of the left, then of the right, sees of (a, b left, a, b right, c)."""
    one, zero = np.ones_like(offset), np.zeros_like(offset)
    left = np.stack([one, -offset, zero, zero, offset**2], axis=-1)
    right = np.stack([zero, zero, one, offset, offset**2], axis=-1)
    return np.concatenate([left, right])
