# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Kernels of grouping: flooding, splitting, following lines."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def flood(order, height, labels):
    """Watershed by immersion: each pixel joins its lowest neighbour under water, else it is a new basin.

    Parameters: ``order`` int64 (H*W), flat indices by rising height; ``height`` uint16 (H, W); ``labels``
    int32 (H, W), zeros, gets 1.. Returns the number of basins. Four neighbours, so basins are 4-connected.
    """
    rows, columns = height.shape
    count = 0
    for i in range(order.size):
        y, x = order[i] // columns, order[i] % columns
        best, lowest = 0, np.int64(1 << 30)
        if y > 0 and labels[y - 1, x] > 0 and height[y - 1, x] < lowest:
            best, lowest = labels[y - 1, x], np.int64(height[y - 1, x])
        if x > 0 and labels[y, x - 1] > 0 and height[y, x - 1] < lowest:
            best, lowest = labels[y, x - 1], np.int64(height[y, x - 1])
        if x + 1 < columns and labels[y, x + 1] > 0 and height[y, x + 1] < lowest:
            best, lowest = labels[y, x + 1], np.int64(height[y, x + 1])
        if y + 1 < rows and labels[y + 1, x] > 0 and height[y + 1, x] < lowest:
            best, lowest = labels[y + 1, x], np.int64(height[y + 1, x])
        if best == 0:
            count += 1
            best = count
        labels[y, x] = best
    return count


@njit(cache=True, nogil=True)
def split(levels, spread, smallest, largest, labels):
    """Quadtree: every square that is even enough and not part of an even one gets a label of its own.

    Parameters: ``levels`` float32 (H, W); ``spread`` the largest standard deviation of an even square;
    ``smallest`` and ``largest`` sides, powers of two; ``labels`` int32 (H, W) gets 1... Returns the number of
    squares. Squares of the smallest side are not split further.
    """
    rows, columns = levels.shape
    down, across = (rows + smallest - 1) // smallest, (columns + smallest - 1) // smallest
    area = np.zeros((down, across), np.int64)
    total = np.zeros((down, across))
    squares = np.zeros((down, across))
    for y in range(rows):
        for x in range(columns):
            j, i = y // smallest, x // smallest
            area[j, i] += 1
            total[j, i] += levels[y, x]
            squares[j, i] += levels[y, x] * levels[y, x]
    leaf = np.zeros((down, across), np.int32)
    count = 0
    side = largest // smallest
    while side >= 1:
        for j0 in range(0, down, side):
            for i0 in range(0, across, side):
                if leaf[j0, i0] > 0:
                    continue
                n, s, q = 0, 0.0, 0.0
                j1, i1 = min(j0 + side, down), min(i0 + side, across)
                for j in range(j0, j1):
                    for i in range(i0, i1):
                        n += area[j, i]
                        s += total[j, i]
                        q += squares[j, i]
                even = n > 0 and q / n - (s / n) ** 2 <= spread * spread
                if even or side == 1:
                    count += 1
                    for j in range(j0, j1):
                        for i in range(i0, i1):
                            leaf[j, i] = count
        side //= 2
    for y in range(rows):
        for x in range(columns):
            labels[y, x] = leaf[y // smallest, x // smallest]
    return count


@njit(cache=True, nogil=True)
def settle(levels, means, variance, stiffness, labels):
    """One sweep in which each pixel at an outline joins the region beside it that fits best.

    Parameters: ``levels`` float32 (H, W); ``means`` float64 by label; ``variance`` of the noise; ``stiffness``
    what a neighbour of another label costs; ``labels`` int32 (H, W), changed in place. Returns how many moved.
    """
    rows, columns = labels.shape
    moved = 0
    for y in range(rows):
        for x in range(columns):
            here = labels[y, x]
            at_outline = (
                (y > 0 and labels[y - 1, x] != here)
                or (x > 0 and labels[y, x - 1] != here)
                or (y + 1 < rows and labels[y + 1, x] != here)
                or (x + 1 < columns and labels[y, x + 1] != here)
            )
            if not at_outline:
                continue
            best, least = here, 1e30
            for side in range(-1, 4):
                ny = y + (side == 0) - (side == 1)
                nx = x + (side == 2) - (side == 3)
                if ny < 0 or ny >= rows or nx < 0 or nx >= columns:
                    continue
                label = labels[ny, nx]
                if side >= 0 and label == here:
                    continue
                cost = (levels[y, x] - means[label]) ** 2 / variance
                for v in range(max(y - 1, 0), min(y + 2, rows)):
                    for u in range(max(x - 1, 0), min(x + 2, columns)):
                        if labels[v, u] != label and (v != y or u != x):
                            cost += stiffness if v == y or u == x else 0.7 * stiffness
                if cost < least:
                    best, least = label, cost
            if best != here:
                labels[y, x] = best
                moved += 1
    return moved


BUCKETS = 2048
# Where the product of two of 1, x, y, x², xy, y² stands among the powers.
PRODUCT = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 3, 4, 6, 7, 8],
        [2, 4, 5, 7, 8, 9],
        [3, 6, 7, 10, 11, 12],
        [4, 7, 8, 11, 12, 13],
        [5, 8, 9, 12, 13, 14],
    ]
)


@njit(cache=True, nogil=True, inline="always")
def _bucket(price):
    """The bucket of a price in [-1, 1); -1 from 1 on: such an arc stays."""
    if not price < 1:
        return -1
    return max(0, int((price + 1) * (BUCKETS // 2)))


@njit(cache=True, nogil=True)
def moments(labels, levels, sums):
    """Sums a region needs for the parabola of its brightness: float64 (R, 22) of x^i y^j and I x^i y^j.

    Parameters: ``labels`` (H, W) from 0, ``levels`` float32 (H, W), ``sums`` zeros. Columns 0 to 14 are the
    powers 1, x, y, x², xy, y², x³ … y⁴; 15 to 20 I times the first six; 21 is I². Coordinates run over [-1, 1]
    along the longer side.
    """
    rows, columns = labels.shape
    half = max(rows, columns, 2) / 2
    for v in range(rows):
        y = (v - rows / 2) / half
        for u in range(columns):
            x = (u - columns / 2) / half
            r, i = labels[v, u], float(levels[v, u])
            to = sums[r]
            xx, xy, yy = x * x, x * y, y * y
            to[0] += 1
            to[1] += x
            to[2] += y
            to[3] += xx
            to[4] += xy
            to[5] += yy
            to[6] += xx * x
            to[7] += xx * y
            to[8] += x * yy
            to[9] += yy * y
            to[10] += xx * xx
            to[11] += xx * xy
            to[12] += xx * yy
            to[13] += xy * yy
            to[14] += yy * yy
            to[15] += i
            to[16] += i * x
            to[17] += i * y
            to[18] += i * xx
            to[19] += i * xy
            to[20] += i * yy
            to[21] += i * i


@njit(cache=True, nogil=True)
def _misfit(one, other, weight, factor, right):
    """Squared residuals of the parabola through one region (``weight`` 0) or two together (1)."""
    area = one[0] + weight * other[0]
    for row in range(6):
        for column in range(row + 1):
            k = PRODUCT[row, column]
            factor[row, column] = one[k] + weight * other[k]
        factor[row, row] += 1e-9 * area
        right[row] = one[15 + row] + weight * other[15 + row]
    left = one[21] + weight * other[21]
    for row in range(6):  # Cholesky, and the right side with it
        for column in range(row + 1):
            value = factor[row, column]
            for k in range(column):
                value -= factor[row, k] * factor[column, k]
            if row == column:
                factor[row, row] = np.sqrt(max(value, 1e-12 * area))
            else:
                factor[row, column] = value / factor[column, column]
        value = right[row]
        for k in range(row):
            value -= factor[row, k] * right[k]
        right[row] = value / factor[row, row]
        left -= right[row] * right[row]
    return max(left, 0.0)


BY_MEANS, BY_STEP, BY_SHADING = 0, 1, 2


@njit(cache=True, nogil=True)
def _price(rule, length, sums, a, b, numbers, work, right):
    """What keeps two regions apart, in parts of what may be chance: they merge below 1.

    ``numbers`` begins with the difference, grey levels, that is none, and with what noise adds to it; BY_STEP
    and BY_SHADING go on with the worth of each channel of votes along the arc, BY_SHADING ends with
    the area below which a region joins a neighbour in any case. ``a`` and ``b`` are rows of
    sums of the regions: [area, total] for BY_MEANS, those of ``moments`` else.
    """
    if rule == BY_MEANS:
        step = abs(a[1] / a[0] - b[1] / b[0])
        return step / (numbers[0] + numbers[1] * np.sqrt(1 / a[0] + 1 / b[0]))
    step = min(abs(sums[0]), abs(sums[1])) / length if sums[0] * sums[1] > 0 else 0.0
    if rule == BY_STEP:
        chance = numbers[0] + numbers[1] / np.sqrt(length)
    else:
        less = min(a[0], b[0])
        apart = _misfit(a, b, 0.0, work, right) + _misfit(b, a, 0.0, work, right)
        misfit = np.sqrt(max(_misfit(a, b, 1.0, work, right) - apart, 0.0) / less)
        step = (misfit + step) / 2
        chance = numbers[0] + numbers[1] / np.sqrt(less)
    for j in range(2, sums.size):
        step += numbers[j] * sums[j] / length
    price = step / chance
    if rule == BY_SHADING and min(a[0], b[0]) < numbers[sums.size] and price > 0:
        return price / (1 + price)  # a scrap joins whatever it is most like
    return price


@njit(cache=True, nogil=True)
def merge(first, second, length, sums, signed, regional, rule, numbers):
    """Greedy merging of regions, cheapest arc first, until every arc costs 1 or more.

    Parameters: ``first``, ``second`` int64 (N): the regions at an arc's sides; ``length`` float64 (N);
    ``sums`` float64 (N, C), of which the first ``signed`` change sign with the arc's direction; ``regional``
    float64 (R, K), sums over the regions. All arrays are changed in place. ``rule`` and ``numbers``: see
    :func:`_price`. Returns int64 (R), the region each has become part of.

    Arcs wait in buckets of price, each arc in one list; pairs of regions are found in a hash table.
    """
    arcs, regions = first.size, regional.shape[0]
    work, right = np.zeros((6, 6)), np.zeros(6)
    home = np.arange(regions)
    kept = np.ones(arcs, np.bool_)
    head, after = np.full(regions, -1, np.int64), np.full(2 * arcs, -1, np.int64)
    size = 16
    while size < 8 * arcs:
        size *= 2
    table = np.full(size, -1, np.int64)
    front = np.full(BUCKETS, -1, np.int64)
    nxt, prv, where = np.full(arcs, -1, np.int64), np.full(arcs, -1, np.int64), np.full(arcs, -1, np.int64)
    degree = np.zeros(regions, np.int64)
    used = 0
    for x in range(arcs):
        a, b = first[x], second[x]
        after[2 * x], head[a] = head[a], 2 * x
        after[2 * x + 1], head[b] = head[b], 2 * x + 1
        degree[a] += 1
        degree[b] += 1
        spot = (min(a, b) * 73856093 ^ max(a, b) * 19349663) & (size - 1)
        while table[spot] >= 0:
            spot = (spot + 1) & (size - 1)
        table[spot] = x
        used += 1
    for x in range(arcs - 1, -1, -1):
        a, b = first[x], second[x]
        price = _price(rule, length[x], sums[x], regional[a], regional[b], numbers, work, right)
        k = _bucket(price)
        where[x] = k
        if k >= 0:
            nxt[x] = front[k]
            if front[k] >= 0:
                prv[front[k]] = x
            front[k] = x
    current = 0
    while current < BUCKETS:
        m = front[current]
        if m < 0:
            current += 1
            continue
        a, b = first[m], second[m]
        if degree[a] < degree[b]:
            a, b = b, a
        home[b] = a
        for j in range(regional.shape[1]):
            regional[a, j] += regional[b, j]
        e = head[b]
        while e >= 0:
            following = after[e]
            x = e // 2
            if kept[x]:
                at_first = first[x] == b
                o = second[x] if at_first else first[x]
                y = -1
                if o != a:
                    spot = (min(a, o) * 73856093 ^ max(a, o) * 19349663) & (size - 1)
                    while table[spot] >= 0:
                        z = table[spot]
                        if kept[z] and (
                            (first[z] == a and second[z] == o) or (first[z] == o and second[z] == a)
                        ):
                            y = z
                            break
                        spot = (spot + 1) & (size - 1)
                if o == a or y >= 0:
                    kept[x] = False
                    if where[x] >= 0:
                        if prv[x] >= 0:
                            nxt[prv[x]] = nxt[x]
                        else:
                            front[where[x]] = nxt[x]
                        if nxt[x] >= 0:
                            prv[nxt[x]] = prv[x]
                        where[x] = -1
                    degree[o] -= 1
                if y >= 0:
                    same = (first[y] == a) == at_first
                    length[y] += length[x]
                    for j in range(sums.shape[1]):
                        sums[y, j] += sums[x, j] if (j >= signed or same) else -sums[x, j]
                elif o != a:
                    if at_first:
                        first[x] = a
                    else:
                        second[x] = a
                    after[e] = head[a]
                    head[a] = e
                    degree[a] += 1
                    if used < size // 2:
                        table[spot] = x
                        used += 1
                    else:
                        used = 0
                        table[:] = -1
                        for z in range(arcs):
                            if kept[z]:
                                p, q = first[z], second[z]
                                at = (min(p, q) * 73856093 ^ max(p, q) * 19349663) & (size - 1)
                                while table[at] >= 0:
                                    at = (at + 1) & (size - 1)
                                table[at] = z
                                used += 1
                    y = x
                if y >= 0:
                    p, q = first[y], second[y]
                    price = _price(rule, length[y], sums[y], regional[p], regional[q], numbers, work, right)
                    k = _bucket(price)
                    if k != where[y]:
                        if where[y] >= 0:
                            if prv[y] >= 0:
                                nxt[prv[y]] = nxt[y]
                            else:
                                front[where[y]] = nxt[y]
                            if nxt[y] >= 0:
                                prv[nxt[y]] = prv[y]
                        where[y] = k
                        prv[y] = -1
                        nxt[y] = -1
                        if k >= 0:
                            nxt[y] = front[k]
                            if front[k] >= 0:
                                prv[front[k]] = y
                            front[k] = y
                            current = min(current, k)
            e = following
    for r in range(regions):
        root = r
        while home[root] != root:
            root = home[root]
        step = r
        while home[step] != root:
            home[step], step = root, home[step]
    return home
