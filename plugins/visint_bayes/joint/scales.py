"""Large images are solved smaller: the surface is smooth, and time stays linear in pixels."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_bayes.joint.setting import Pair

__all__ = ["LARGEST", "enlarged", "halved"]

LARGEST = 384
"""Longest side, px, at which the candidates are solved."""


def halved(pair: Pair) -> Pair:
    """The pair one level coarser."""
    inside, inside_right = (_mean(mask.astype(np.float32)) > 0.5 for mask in (pair.inside, pair.inside_right))
    left, right = _mean(pair.left), _mean(pair.right)
    stereo, stereo_right = (_mean(field) / 2 for field in (pair.stereo, pair.stereo_right))
    return Pair(left, right, inside, inside_right, stereo, stereo_right, pair.camera.halved(), pair.light)


def _mean(field: Array) -> Array:
    """Means of blocks of 2 x 2; odd sides are padded by their last row or column."""
    rows, columns = field.shape
    whole = np.pad(field, ((0, rows % 2), (0, columns % 2)), mode="edge")
    total = whole[::2, ::2] + whole[1::2, ::2] + whole[::2, 1::2] + whole[1::2, 1::2]
    return np.asarray(total / 4, np.float32)


def enlarged(field: Array, inside: Array, size: tuple[int, ...]) -> Array:
    """A map of the inside (H, W) at twice the size, linear in between; the outside takes the nearest inside.

    Values stay: disparities are to be doubled by the caller.
    """
    from scipy.ndimage import distance_transform_edt

    filled = field
    if inside.any() and not inside.all():
        nearest = distance_transform_edt(~inside, return_distances=False, return_indices=True)
        filled = field[tuple(nearest)]
    return _twice(_twice(filled, 0), 1)[: size[0], : size[1]]


def _twice(field: Array, axis: int) -> Array:
    """Twice as many samples along an axis: cell centres, so weights of 3/4 and 1/4."""
    field = np.moveaxis(field, axis, 0)
    before, after = np.concatenate([field[:1], field[:-1]]), np.concatenate([field[1:], field[-1:]])
    out = np.empty((2 * len(field), *field.shape[1:]), field.dtype)
    out[::2], out[1::2] = 0.75 * field + 0.25 * before, 0.75 * field + 0.25 * after
    return np.asarray(np.moveaxis(out, 0, axis))
