# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Kernels of region planes: superpixels, robust planes, and what each plane costs each region.

Planes are rows (a, b, c) of float64: d = a x + b y + c with x, y in pixels from the image's corner.
Regions are numbered from 0; ``order`` lists flat pixels region by region, those of region r being
``order[starts[r]:starts[r + 1]]``.
"""

from __future__ import annotations

import numpy as np
from numba import njit

OFFSETS = ((0, 1), (1, 0), (1, 1), (1, -1))
GRADES = 16
"""Steps of a sorted edge weight to each grey level."""


@njit(cache=True, nogil=True, inline="always")
def _root(home, i):
    while home[i] != i:
        home[i] = home[home[i]]
        i = home[i]
    return i


@njit(cache=True, nogil=True)
def _sorted_edges(colour, one, other, weight):
    """8-connected edges in ascending order of their weight, by counting; returns how many there are."""
    rows, columns, channels = colour.shape
    bins = 442 * GRADES + 2
    counts = np.zeros(bins + 1, np.int64)
    for turn in range(2):
        for y in range(rows):
            for x in range(columns):
                for dy, dx in OFFSETS:
                    v, u = y + dy, x + dx
                    if v >= rows or u < 0 or u >= columns:
                        continue
                    squares = np.float32(0)
                    for c in range(channels):
                        step = colour[y, x, c] - colour[v, u, c]
                        squares += step * step
                    step = np.sqrt(squares)
                    grade = min(np.int64(step * GRADES), bins - 2)
                    if turn == 0:
                        counts[grade + 1] += 1
                    else:
                        place = counts[grade]
                        counts[grade] += 1
                        one[place] = y * columns + x
                        other[place] = v * columns + u
                        weight[place] = step
        if turn == 0:
            for b in range(bins):
                counts[b + 1] += counts[b]
    return counts[bins - 1]


@njit(cache=True, nogil=True)
def superpixels(colour, breadth, smallest, home):
    """Felzenszwalb and Huttenlocher's segmentation: colour float32 (H, W, C) -> home int32 (H W), roots."""
    rows, columns = colour.shape[:2]
    room = 4 * rows * columns
    one, other = np.empty(room, np.int32), np.empty(room, np.int32)
    weight = np.empty(room, np.float32)
    count = _sorted_edges(colour, one, other, weight)
    size = np.ones(rows * columns, np.int32)
    limit = np.full(rows * columns, breadth, np.float32)
    for i in range(rows * columns):
        home[i] = i
    for e in range(count):
        a, b = _root(home, one[e]), _root(home, other[e])
        if a != b and weight[e] <= limit[a] and weight[e] <= limit[b]:
            home[b] = a
            size[a] += size[b]
            limit[a] = weight[e] + breadth / size[a]
    for e in range(count):
        a, b = _root(home, one[e]), _root(home, other[e])
        if a != b and (size[a] < smallest or size[b] < smallest):
            home[b] = a
            size[a] += size[b]
    for i in range(rows * columns):
        home[i] = _root(home, i)


@njit(cache=True, nogil=True)
def listed(labels, count, starts, order):
    """Pixels region by region: labels int32 (N,) -> starts int64 (count + 1,), order int32 (N,)."""
    for i in range(labels.size):
        starts[labels[i] + 1] += 1
    for r in range(count):
        starts[r + 1] += starts[r]
    place = starts[:-1].copy()
    for i in range(labels.size):
        order[place[labels[i]]] = i
        place[labels[i]] += 1


@njit(cache=True, nogil=True, inline="always")
def _solved(m, v):
    """x of the symmetric 3×3 system m x = v, by Cramer's rule; zeros where it is singular."""
    c00 = m[1, 1] * m[2, 2] - m[1, 2] * m[1, 2]
    c01 = m[0, 2] * m[1, 2] - m[0, 1] * m[2, 2]
    c02 = m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]
    det = m[0, 0] * c00 + m[0, 1] * c01 + m[0, 2] * c02
    x = np.zeros(3)
    if abs(det) > 1e-9:
        c11 = m[0, 0] * m[2, 2] - m[0, 2] * m[0, 2]
        c12 = m[0, 1] * m[0, 2] - m[0, 0] * m[1, 2]
        c22 = m[0, 0] * m[1, 1] - m[0, 1] * m[0, 1]
        x[0] = (c00 * v[0] + c01 * v[1] + c02 * v[2]) / det
        x[1] = (c01 * v[0] + c11 * v[1] + c12 * v[2]) / det
        x[2] = (c02 * v[0] + c12 * v[1] + c22 * v[2]) / det
    return x


@njit(cache=True, nogil=True)
def fitted(disparity, votes, columns, starts, order, settings, planes, support, share):
    """A robust plane for each region.

    Hypotheses through three voters (every fourth level), scored by sum w max(0, 1 - r²); then reweighted
    least squares by Tukey's weight at 1.5 px with a ridge on the slopes.

    disparity, votes: float32 (N,); settings: (hypotheses, steepest, reach, Tukey's width, ridge, most voters
    looked at); planes float64 (R, 3); support float32 (R,): summed votes; share: votes within reach.
    """
    hypotheses, steepest, reach, width, ridge, most = settings
    voters = np.empty(order.size, np.int32)
    for r in range(starts.size - 1):
        count, total = 0, 0.0
        for i in range(starts[r], starts[r + 1]):
            if votes[order[i]] > 0:
                voters[count] = order[i]
                total += votes[order[i]]
                count += 1
        support[r] = total
        share[r] = 0.0
        if count < 3:
            continue
        stride = max(1, count // np.int64(most))
        state = np.uint32(12345)
        best, found = -1.0, np.zeros(3)
        trial = np.zeros(3)
        three = np.zeros(3, np.int64)
        for h in range(np.int64(hypotheses)):
            for j in range(3):
                state = np.uint32(state * np.uint32(1664525) + np.uint32(1013904223))
                three[j] = voters[np.int64(state >> np.uint32(8)) % count]
            x0, y0, d0 = three[0] % columns, three[0] // columns, disparity[three[0]]
            trial[0] = trial[1] = 0.0
            trial[2] = d0
            if h % 4:
                x1, y1, d1 = three[1] % columns - x0, three[1] // columns - y0, disparity[three[1]] - d0
                x2, y2, d2 = three[2] % columns - x0, three[2] // columns - y0, disparity[three[2]] - d0
                det = x1 * y2 - x2 * y1
                if det == 0:
                    continue
                a, b = (d1 * y2 - d2 * y1) / det, (x1 * d2 - x2 * d1) / det
                if abs(a) > steepest or abs(b) > steepest:
                    continue
                trial[0], trial[1], trial[2] = a, b, d0 - a * x0 - b * y0
            score = 0.0
            for i in range(0, count, stride):
                p = voters[i]
                off = trial[0] * (p % columns) + trial[1] * (p // columns) + trial[2] - disparity[p]
                score += votes[p] * max(0.0, 1 - (off / reach) ** 2)
            if score > best:
                best = score
                found[:] = trial
        _polished(disparity, votes, columns, voters[:count], (width, ridge, steepest), found)
        near = 0.0
        for i in range(count):
            p = voters[i]
            off = found[0] * (p % columns) + found[1] * (p // columns) + found[2] - disparity[p]
            if abs(off) < reach:
                near += votes[p]
        share[r] = near / total
        planes[r] = found


@njit(cache=True, nogil=True)
def _polished(disparity, votes, columns, voters, settings, plane):
    """Four steps of reweighted least squares, in place."""
    width, ridge, steepest = settings
    matrix, side, at = np.zeros((3, 3)), np.zeros(3), np.ones(3)
    for _ in range(4):
        mx, my, total = 0.0, 0.0, 0.0
        for p in voters:
            mx += votes[p] * (p % columns)
            my += votes[p] * (p // columns)
            total += votes[p]
        mx, my = mx / total, my / total
        matrix[:] = 0
        side[:] = 0
        for p in voters:
            x, y = p % columns, p // columns
            off = plane[0] * x + plane[1] * y + plane[2] - disparity[p]
            t = 1 - (off / width) ** 2
            if t <= 0:
                continue
            w = votes[p] * t * t
            at[0], at[1] = x - mx, y - my
            for i in range(3):
                side[i] += w * at[i] * disparity[p]
                for j in range(3):
                    matrix[i, j] += w * at[i] * at[j]
        if matrix[2, 2] <= 0:
            return
        matrix[0, 0] += ridge
        matrix[1, 1] += ridge
        new = _solved(matrix, side)
        if abs(new[0]) > steepest or abs(new[1]) > steepest:
            return
        plane[0], plane[1] = new[0], new[1]
        plane[2] = new[2] - new[0] * mx - new[1] * my


@njit(cache=True, nogil=True, inline="always")
def _bits(word):
    word = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    word = (word & np.uint64(0x3333333333333333)) + ((word >> np.uint64(2)) & np.uint64(0x3333333333333333))
    word = (word + (word >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return np.float32((word * np.uint64(0x0101010101010101)) >> np.uint64(56))


@njit(cache=True, nogil=True)
def census(image, words):
    """9×7 census: image padded by (3, 4) on each side -> words uint64 (H, W)."""
    rows, columns = words.shape
    for y in range(rows):
        for x in range(columns):
            words[y, x] = np.uint64(0)
        for dy in range(7):
            for dx in range(9):
                if dy == 3 and dx == 4:
                    continue
                for x in range(columns):
                    bit = np.uint64(image[y + dy, x + dx] < image[y + 3, x + 4])
                    words[y, x] = (words[y, x] << np.uint64(1)) | bit


VIOLATED, OUTSIDE, OCCLUDED, SEEN = np.uint8(0), np.uint8(1), np.uint8(2), np.uint8(3)


@njit(cache=True, nogil=True, inline="always")
def _sight(x, y, value, right):
    """(what the right view says to a surface of disparity ``value`` at (x, y), its column there)."""
    columns = right.shape[1]
    there = np.int64(np.floor(x - value + 0.5))
    if there < 0 or there >= columns:
        return OUTSIDE, 0
    back = right[y, there]
    if back < value - 1:
        return VIOLATED, there
    if back > value + 1.5:
        return OCCLUDED, there
    return SEEN, there


@njit(cache=True, nogil=True)
def energies(disparity, votes, right, views, listing, planes, candidates, span, costs, coverage):
    """What each candidate plane costs each region, in [0, 1], and how it suits the region's own voters.

    disparity, votes, right: float32 (H, W), right NaN where unknown; views: census words of both, uint64;
    listing: (starts, order); candidates: (region, plane) int32 (M, 2); span: least and largest disparity;
    costs float32 (M,); coverage float32 (M, 2): share of votes within 1 px, votes a pixel.
    """
    here, there_words = views
    starts, order = listing
    columns = disparity.shape[1]
    low, high = span
    for m in range(candidates.shape[0]):
        r = candidates[m, 0]
        a, b, c = planes[candidates[m, 1]]
        total, weights, near, voted = 0.0, 0.0, 0.0, 0.0
        stride = max(1, (starts[r + 1] - starts[r]) // 1500)
        looked = 0
        for i in range(starts[r], starts[r + 1], stride):
            p = order[i]
            y, x = p // columns, p % columns
            value = np.float32(a * x + b * y + c)
            w = votes[y, x]
            looked += 1
            if w > 0:
                off = abs(value - disparity[y, x])
                total += w * min(off / 2, 1.0)
                weights += w
                voted += w
                if off < 1:
                    near += w
                continue
            weights += 0.5
            sight, there = _sight(x, y, value, right)
            if value < low or value > high or sight == VIOLATED:
                total += 0.5
            elif sight != SEEN:
                total += 0.15
            else:
                total += 0.5 * min(_bits(here[y, x] ^ there_words[y, there]) / 40, 1.0)
        costs[m] = total / weights if weights > 0 else 1.0
        coverage[m, 0] = near / voted if voted > 0 else 0.0
        coverage[m, 1] = voted / max(looked, 1)


@njit(cache=True, nogil=True)
def settled(costs, offsets, candidates, arcs, sweeps, agreement, chosen):
    """The candidate of least energy for each region, its neighbours' choices considered; -1 for none.

    Candidates of region r are offsets[r]:offsets[r + 1]; arcs: (offsets, neighbour, length) of each region;
    ``agreement`` is what is gained where all of the outline borders on regions of the same plane.
    """
    begins, neighbours, lengths = arcs
    for turn in range(sweeps + 1):
        for r in range(offsets.size - 1):
            best, least = -1, np.inf
            around = 0.0
            for n in range(begins[r], begins[r + 1]):
                around += lengths[n]
            for m in range(offsets[r], offsets[r + 1]):
                cost = costs[m]
                if turn > 0:
                    same = 0.0
                    for n in range(begins[r], begins[r + 1]):
                        other = chosen[neighbours[n]]
                        if other >= 0 and candidates[other, 1] == candidates[m, 1]:
                            same += lengths[n]
                    cost -= agreement * same / max(around, 1.0)
                if cost < least:
                    best, least = m, cost
            chosen[r] = best


@njit(cache=True, nogil=True)
def laid(labels, planes, right, span, value, sight):
    """Each pixel's plane as disparity and what the right view says to it: value float32, sight uint8 (H, W).

    planes float64 (R, 3), NaN where a region has none.
    """
    rows, columns = labels.shape
    low, high = span
    for y in range(rows):
        for x in range(columns):
            a, b, c = planes[labels[y, x]]
            d = np.float32(a * x + b * y + c)
            value[y, x] = d
            sight[y, x] = VIOLATED
            if d >= low and d <= high:
                sight[y, x] = _sight(x, y, d, right)[0]
