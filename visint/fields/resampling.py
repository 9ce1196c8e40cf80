"""Going down and up one level of resolution: the rules that the field kinds choose from.

A level halves both sides. Odd sides are padded by their last row or column first, so the factor is exactly
2 and pixel centres map by (x + ½)/2 − ½. Going up, the finer size is given and the padding cut off.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from visint.arrays import Array

__all__ = [
    "any_down",
    "block_mean",
    "levels_down_to",
    "linear_up",
    "most_frequent_down",
    "most_significant_down",
    "nearest_up",
    "quadratic_up",
    "region_boundaries",
    "renormalised",
    "smaller",
]

Size = tuple[int, int]
Pair = Callable[[Array, Array, Array], tuple[Array, Array]]


def smaller(size: Size) -> Size:
    """The (rows, columns) one level coarser."""
    return (size[0] + 1) // 2, (size[1] + 1) // 2


def levels_down_to(size: Size, coarsest: int) -> int:
    """How many levels a pyramid has whose coarsest level's shorter side is still at least ``coarsest``."""
    count = 1
    while min(smaller(size)) >= coarsest and smaller(size) != size:
        size, count = smaller(size), count + 1
    return count


def _blocks(value: Array) -> Array:
    """(4, H/2, W/2, …): the four pixels of each block, row by row."""
    pad = [(0, value.shape[0] % 2), (0, value.shape[1] % 2)] + [(0, 0)] * (value.ndim - 2)
    even = np.pad(value, pad, mode="edge")
    return np.stack([even[0::2, 0::2], even[0::2, 1::2], even[1::2, 0::2], even[1::2, 1::2]])


def block_mean(value: Array) -> Array:
    """Mean of the known pixels of each block; NaN where none is known. float32, any number of channels."""
    blocks = _blocks(value)
    known = np.isfinite(blocks)
    total = np.where(known, blocks, 0).sum(axis=0, dtype=np.float32)
    count = known.sum(axis=0, dtype=np.float32)
    with np.errstate(invalid="ignore"):
        return np.where(count > 0, total / count, np.float32(np.nan)).astype(np.float32)


def any_down(value: Array) -> Array:
    """bool: whether any pixel of the block is set. Thin lines live on."""
    return np.asarray(_blocks(value).any(axis=0))


def most_significant_down(value: Array) -> Array:
    """uint8: the smallest of the block's values that is not 0; 0 if all are. Thin lines live on.

    For kinds of boundary, which are numbered from the most significant on.
    """
    blocks = _blocks(value)
    return np.asarray((blocks - np.uint8(1)).min(axis=0) + np.uint8(1))  # 0 wraps round to the largest


def most_frequent_down(value: Array) -> Array:
    """int32: the most frequent label of the block; among equals the rarer in the whole map, then the smaller.

    A label that no block would keep gets one of the blocks it occurs in, as long as there is room: so small
    regions live on through many levels. Label 0 (boundary) counts as a label.
    """
    blocks = _blocks(value)
    votes = (blocks[:, None] == blocks[None, :]).sum(axis=1)
    labels, index, area = np.unique(blocks, return_inverse=True, return_counts=True)
    index = index.reshape(4, -1)
    rank = np.empty(len(labels), dtype=np.int64)
    rank[np.lexsort((labels, area))] = np.arange(len(labels))
    score = votes.reshape(4, -1) * (len(labels) + 1) - rank[index]
    best = np.take_along_axis(index, score.argmax(axis=0)[None], axis=0)[0]
    kept = _with_the_lost(best, index, len(labels))
    return labels[kept].reshape(blocks.shape[1:]).astype(np.int32)


def _with_the_lost(winners: Array, members: Array, labels: int) -> Array:
    """``winners`` (N), the label of each block, with a block for every label that won none.

    Each takes the block where it has most of the four ``members`` (4, N), unless that one was taken so, or
    is the last of its present label. Where two want one block the other tries again.
    """
    taken = np.zeros(len(winners), dtype=bool)
    for _ in range(4):
        count = np.bincount(winners, minlength=labels)
        free = ~taken & (count[winners] > 1)
        pixel, block = np.nonzero((count[members] == 0) & free)
        if not len(block):
            break
        label = members[pixel, block]
        votes = (members[:, block] == label).sum(axis=0)
        order = np.lexsort((block, -votes, label))
        wanted = order[np.unique(label[order], return_index=True)[1]]
        spot, first = np.unique(block[wanted], return_index=True)
        winners[spot], taken[spot] = label[wanted][first], True
    return winners


def nearest_up(value: Array, size: Size) -> Array:
    """Each pixel four times, cut to ``size``. Any dtype."""
    doubled = value.repeat(2, axis=0).repeat(2, axis=1)
    return np.ascontiguousarray(doubled[: size[0], : size[1]])


def linear_up(value: Array, size: Size) -> Array:
    """Bilinear by pixel centres (weights ¾ and ¼), cut to ``size``; unknown pixels take no part. float32."""
    weight = np.isfinite(value).astype(np.float32)
    total = _along_both(np.where(weight > 0, value, 0).astype(np.float32), _linear_pair)
    share = _along_both(weight, _linear_pair)
    with np.errstate(divide="ignore", invalid="ignore"):
        raised = np.where(share > 0.25, total / share, np.float32(np.nan))
    return _cut(raised, size)


def quadratic_up(value: Array, size: Size) -> Array:
    """Quadratic by pixel centres, cut to ``size``: the inverse of :func:`block_mean` for parabolas. float32.

    Each child lies a quarter of the coarse gradient from its parent: block means of a parabola a + bx + cx²
    carry the very c/16 that its fine samples have, so no curvature term is wanted. Where a neighbour is
    unknown the step is linear.
    """
    smooth = _cut(_along_both(value, _quadratic_pair), size)
    return np.where(np.isfinite(smooth), smooth, linear_up(value, size))


def _linear_pair(before: Array, here: Array, after: Array) -> tuple[Array, Array]:
    return 0.75 * here + 0.25 * before, 0.75 * here + 0.25 * after


def _quadratic_pair(before: Array, here: Array, after: Array) -> tuple[Array, Array]:
    step = (after - before) / 8
    return here - step, here + step


def _along_both(value: Array, pair: Pair) -> Array:
    """Doubles both axes, each pixel becoming the two children that ``pair`` makes of it and its neighbours."""
    for axis in (0, 1):
        rows = np.moveaxis(value, axis, 0)
        padded = np.concatenate([rows[:1], rows, rows[-1:]])
        if pair is _quadratic_pair and len(rows) > 1:  # keep the border's slope: repeat it, not the value
            padded[0], padded[-1] = 2 * rows[0] - rows[1], 2 * rows[-1] - rows[-2]
        children = np.stack(pair(padded[:-2], rows, padded[2:]), axis=1)
        value = np.moveaxis(children.reshape((2 * len(rows), *rows.shape[1:])), 0, axis)
    return value


def _cut(value: Array, size: Size) -> Array:
    return np.ascontiguousarray(value[: size[0], : size[1]], dtype=np.float32)


def renormalised(normals: Array) -> Array:
    """Unit vectors (H, W, C) again after averaging; NaN where they cancel."""
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(length > 0, normals / length, np.float32(np.nan)).astype(np.float32)


def region_boundaries(regions: Array) -> Array:
    """Bool (H, W): label 0, and pixels whose right or lower neighbour has another label."""
    edges = regions == 0
    edges[:, :-1] |= regions[:, :-1] != regions[:, 1:]
    edges[:-1] |= regions[:-1] != regions[1:]
    return np.asarray(edges)
