# mypy: ignore-errors
# ruff: noqa: ARG001, PLR0917 - numba fixes the arguments of an intrinsic, and kernels take what they need
"""Kernels of semi-global matching: census, Hamming costs, path costs, winners.

Bytes stay bytes: numba widens small integers to 64 bits, and then LLVM does not vectorise. The intrinsics
below add and compare without widening. Volumes are flat, index ``(y * W + x) * D + k``; indices are unsigned,
which spares the test for negative ones.
"""

from __future__ import annotations

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

U = np.uint64
SENTINEL = np.uint8(180)
"""Cost beyond both ends of the range: above every path cost (62 + 100), and 180 + P1 still fits a byte."""


@intrinsic
def _popcount(typingctx, a):
    def build(context, builder, signature, args):
        return builder.trunc(builder.ctpop(args[0]), ir.IntType(8))

    return types.uint8(types.uint64), build


@intrinsic
def _add(typingctx, a, b):
    def build(context, builder, signature, args):
        return builder.add(*args)

    return types.uint8(types.uint8, types.uint8), build


@intrinsic
def _sub(typingctx, a, b):
    def build(context, builder, signature, args):
        return builder.sub(*args)

    return types.uint8(types.uint8, types.uint8), build


@intrinsic
def _least(typingctx, a, b):
    def build(context, builder, signature, args):
        return builder.select(builder.icmp_unsigned("<", *args), *args)

    return a(a, a), build


@intrinsic
def _sum16(typingctx, a, b):
    def build(context, builder, signature, args):
        return builder.add(args[0], builder.zext(args[1], ir.IntType(16)))

    return types.uint16(types.uint16, types.uint8), build


@intrinsic
def _count_up_to(typingctx, count, value, limit):
    def build(context, builder, signature, args):
        below = builder.icmp_unsigned("<=", args[1], args[2])
        return builder.add(args[0], builder.zext(below, ir.IntType(16)))

    return types.uint16(types.uint16, types.uint16, types.uint16), build


@njit(cache=True, nogil=True)
def census(image, words):
    """9×7 census: image uint16 padded by (3, 4) on each side -> words uint64 (H, W)."""
    rows, columns = words.shape
    for y in range(rows):
        for x in range(columns):
            words[y, x] = U(0)
        for dy in range(7):
            for dx in range(9):
                if dy == 3 and dx == 4:
                    continue
                for x in range(columns):
                    bit = U(image[y + dy, x + dx] < image[y + 3, x + 4])
                    words[y, x] = (words[y, x] << U(1)) | bit


@njit(cache=True, nogil=True)
def hamming(left, mirrored, first, base, neutral, cost):
    """Census distances: left uint64 (H, W), right mirrored in x -> cost uint8 (H, W, D).

    Level k of a pixel is the disparity d = first + base[y, x] + k; base int32 (H, W).
    Where the right pixel x - d lies outside the image the cost is ``neutral``: neither for nor against.
    """
    rows, columns, depth = cost.shape
    for y in range(rows):
        for x in range(columns):
            start = columns - 1 - x + first + base[y, x]
            begin = min(max(0, -start), depth)
            end = max(begin, min(depth, columns - start))
            for k in range(begin):
                cost[y, x, k] = neutral
            for k in range(end, depth):
                cost[y, x, k] = neutral
            word = left[y, x]
            for k in range(U(begin), U(end)):
                cost[y, x, k] = _popcount(word ^ mirrored[y, U(U(start + begin) + (k - U(begin)))])


@njit(cache=True, nogil=True)
def lean_on(cost, value, weight, first, base):
    """Adds to ``cost`` uint8 (H, W, D) what a level costs for lying off a prior: 4 a px up to 12, weighted.

    value, weight float32 (H, W); where weight is 0 nothing is added.
    """
    rows, columns, depth = cost.shape
    for y in range(rows):
        for x in range(columns):
            if weight[y, x] > 0:
                low = np.float32(first + base[y, x])
                for k in range(depth):
                    off = np.float32(4) * abs(value[y, x] - low - np.float32(k))
                    more = weight[y, x] * min(off, np.float32(12)) + np.float32(0.5)
                    cost[y, x, k] = _add(cost[y, x, k], np.uint8(more))


@njit(cache=True, nogil=True, inline="always")
def _walk(paths, before, here, floor, cost, at, total, depth, small, large):
    """One pixel of one path: its costs into ``paths[here:]``, added to ``total``; returns their minimum.

    L(p, d) = C(p, d) + min(L(q, d), L(q, d ± 1) + P1, min L(q) + P2) - min L(q)
    """
    jump = _add(floor, large)
    least = np.uint8(255)
    for k in range(depth):
        best = paths[before + k + U(1)]
        best = _least(best, _add(paths[before + k], small))
        best = _least(best, _add(paths[before + k + U(2)], small))
        best = _least(best, jump)
        value = _add(cost[at + k], _sub(best, floor))
        paths[here + k + U(1)] = value
        least = _least(least, value)
    for k in range(depth):
        total[at + k] = _sum16(total[at + k], paths[here + k + U(1)])
    return least


@njit(cache=True, nogil=True)
def aggregate(cost, shape, base, lean, pad, brightness, small, steep, total, way):
    """Four of the eight paths: from the left and from above (``way`` 1), or from the right and below (-1).

    Parameters: cost uint8 flat; base int32 (H, W) as in :func:`hamming` (neighbours' levels are shifted to
    stand for the same disparity, by at most ``pad``: D if base varies, 0 if it is 0); lean int32 (H, W): whole
    levels of a surface that is followed without a penalty where it steps by at most 2 (SGM-P: Scharstein,
    Taniai and Sinha 2017, doi:10.1109/3DV.2017.00034), which wants a ``pad`` of 2; brightness uint8 (H, W);
    ``small`` P1; ``steep`` uint8 (256,) P2 by brightness step; total uint16 flat, added to.
    """
    rows, columns, wide = shape
    depth = U(wide)
    stride = U(wide + 2 + 2 * pad)
    # paths 0 to 2 come from the row before (diagonal, vertical, diagonal), path 3 along this row. A pixel's
    # slot lies before its predecessor's: LLVM's test for overlap would otherwise refuse to vectorise path 3.
    paths = np.full(2 * 4 * (columns + 2) * (wide + 2 + 2 * pad), SENTINEL, dtype=np.uint8)
    floors = np.zeros((2, 4, columns + 2), dtype=np.uint8)
    first_row, first_column = (0, 0) if way > 0 else (rows - 1, columns - 1)
    for row in range(rows):
        y = first_row + way * row
        now, then = row % 2, 1 - row % 2
        for column in range(columns):
            x = first_column + way * column
            at = U((y * columns + x) * wide)
            for path in range(4):
                past = column - (path - 1 if path < 3 else 1)
                half = then if path < 3 else now
                py, px = y - way if path < 3 else y, first_column + way * past
                slot = columns - column
                here = U((now * 4 + path) * (columns + 2) + slot) * stride + U(pad)
                if past < 0 or past >= columns or py < 0 or py >= rows:
                    least = np.uint8(255)
                    for k in range(depth):
                        value = cost[at + k]
                        paths[here + k + U(1)] = value
                        least = _least(least, value)
                        total[at + k] = _sum16(total[at + k], value)
                else:
                    shift = base[y, x] - base[py, px]
                    climb = lean[y, x] - lean[py, px]
                    if abs(climb) <= 2:
                        shift -= climb
                    shift = min(max(shift, -pad), pad)
                    before = U((half * 4 + path) * (columns + 2) + columns - past) * stride + U(pad + shift)
                    step = abs(np.int64(brightness[y, x]) - np.int64(brightness[py, px]))
                    floor = floors[half, path, columns - past]
                    least = _walk(paths, before, here, floor, cost, at, total, depth, small, steep[step])
                floors[now, path, slot] = least


@njit(cache=True, nogil=True)
def _first_of_least(total, at, depth):
    """(level, cost): the first of the cheapest among ``depth`` levels from ``at`` on."""
    low = np.uint16(65535)
    for k in range(depth):
        low = _least(low, total[at + k])
    k = U(0)
    while total[at + k] != low:
        k += U(1)
    return k, low


@njit(cache=True, nogil=True)
def winners(total, shape, best, least, second, crowd):
    """The cheapest level of each pixel, its cost, the second cost outside ±1, and how many come near it.

    best int32, least, second and crowd uint16 (H, W); near is S <= 9/8 min S + 24.
    """
    rows, columns, wide = shape
    depth = U(wide)
    for y in range(rows):
        for x in range(columns):
            at = U((y * columns + x) * wide)
            k, low = _first_of_least(total, at, depth)
            best[y, x] = np.int32(k)
            least[y, x] = low
            limit = np.uint16(low + (low >> 3) + 24)
            count = np.uint16(0)
            for j in range(depth):
                count = _count_up_to(count, total[at + j], limit)
            crowd[y, x] = count
            other = np.uint16(65535)
            if k > U(1):
                for j in range(k - U(1)):
                    other = _least(other, total[at + j])
            for j in range(k + U(2), depth):
                other = _least(other, total[at + j])
            second[y, x] = other


@njit(cache=True, nogil=True)
def right_winners(total, shape, first, base, best):
    """The cheapest disparity of each right pixel from the same volume: min over d of S(x + d, d); int32."""
    rows, columns, wide = shape
    # mirrored and shifted: disparity first + l of pixel x goes to slot (columns - 1 - x + l), ascending with l
    slots = columns + wide + base.max()
    lows = np.empty(slots, dtype=np.uint16)
    levels = np.empty(slots, dtype=np.uint16)
    for y in range(rows):
        lows[:] = np.uint16(65535)
        levels[:] = np.uint16(0)
        for x in range(columns):
            at = U((y * columns + x) * wide)
            slot = U(columns - 1 - x + base[y, x])
            floor = U(base[y, x])
            for k in range(U(wide)):
                cheaper = total[at + k] < lows[slot + k]
                lows[slot + k] = total[at + k] if cheaper else lows[slot + k]
                levels[slot + k] = np.uint16(floor + k) if cheaper else levels[slot + k]
        for x in range(columns):
            slot = columns - 1 - x - first
            best[y, x] = -32768
            if 0 <= slot < slots and lows[slot] < 65535:
                best[y, x] = first + np.int32(levels[slot])


@njit(cache=True, nogil=True)
def between_levels(total, shape, best, first, base, disparity):
    """Sub-pixel disparity float32 (H, W): V-shaped (equiangular) fit through three costs."""
    rows, columns, wide = shape
    for y in range(rows):
        for x in range(columns):
            k = np.int64(best[y, x])
            value = np.float32(first + base[y, x] + k)
            if 0 < k < wide - 1:
                at = (y * columns + x) * wide + k
                low = np.float32(total[at])
                before = np.float32(total[at - 1]) - low
                after = np.float32(total[at + 1]) - low
                top = max(before, after)
                if top > 0:
                    value += np.float32(0.5) * (before - after) / top
            disparity[y, x] = value


@njit(cache=True, nogil=True)
def warp(image, disparity, values, slopes):
    """``image`` and its slope along the row at x - d, by Catmull-Rom cubics; all float32 (H, W)."""
    rows, columns = image.shape
    last = columns - 1
    half, two = np.float32(0.5), np.float32(2)
    for y in range(rows):
        for x in range(columns):
            place = np.float32(x) - disparity[y, x]
            left = np.int64(np.floor(place))
            t = place - np.float32(left)
            a = image[y, min(max(left - 1, 0), last)]
            b = image[y, min(max(left, 0), last)]
            c = image[y, min(max(left + 1, 0), last)]
            d = image[y, min(max(left + 2, 0), last)]
            c1 = half * (c - a)
            c2 = a - np.float32(2.5) * b + two * c - half * d
            c3 = half * (d - a) + np.float32(1.5) * (b - c)
            values[y, x] = b + t * (c1 + t * (c2 + t * c3))
            slopes[y, x] = c1 + t * (two * c2 + np.float32(3) * t * c3)


@njit(cache=True, nogil=True)
def filling_costs(disparity, trusted, right, right_trusted, first, base, cost):
    """What each level would cost a filled pixel: cost uint8 (H, W, D), levels as in :func:`hamming`.

    A trusted pixel keeps to its own value, 20 a px up to 60. Elsewhere 4 at every level, and 30 where the
    surface would hide from the right view something that it sees behind.
    """
    rows, columns, depth = cost.shape
    for y in range(rows):
        for x in range(columns):
            low = first + base[y, x]
            if trusted[y, x]:
                for k in range(depth):
                    off = abs(disparity[y, x] - np.float32(low + k))
                    cost[y, x, k] = np.uint8(min(np.float32(20) * off, np.float32(60)))
                continue
            for k in range(depth):
                there = x - low - k
                hides = 0 <= there < columns and right_trusted[y, there] and right[y, there] < low + k - 1
                cost[y, x, k] = np.uint8(30 if hides else 4)


@njit(cache=True, nogil=True)
def cheapest(total, shape, first, base, disparity):
    """The disparity of the least cost of each pixel, float32 (H, W), whole levels."""
    rows, columns, wide = shape
    depth = U(wide)
    for y in range(rows):
        for x in range(columns):
            at = U((y * columns + x) * wide)
            k, _ = _first_of_least(total, at, depth)
            disparity[y, x] = np.float32(first + base[y, x] + np.int64(k))
