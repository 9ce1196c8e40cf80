# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Kernels of region planes: superpixels, robust planes, and what each plane costs each region.

Planes are rows (a, b, c) of float64: d = a x + b y + c with x, y in pixels from the image's corner.
Regions are numbered from 0; ``order`` lists pixels (row << 20 | column) region by region, those of region r
being ``order[starts[r]:starts[r + 1]]``.
"""

from __future__ import annotations

import numpy as np
from numba import njit

OFFSETS = ((0, 1), (1, 0), (1, 1), (1, -1))
GRADES = 16
"""Steps of a sorted edge weight to each grey level."""
NO_EDGE = 442 * GRADES
"""Above every grade: 255 √3 grey levels at most."""
HALF = 20
"""Bits of a listed pixel that hold its column; those above hold its row."""
MASK = (1 << HALF) - 1


@njit(cache=True, nogil=True, inline="always")
def _root(home, i):
    while home[i] != i:
        home[i] = home[home[i]]
        i = home[i]
    return i


@njit(cache=True, nogil=True, inline="always")
def _step(colour, y, x, v, u):
    squares = np.float32(0)
    for c in range(colour.shape[2]):
        off = colour[y, x, c] - colour[v, u, c]
        squares += off * off
    return np.sqrt(squares)


@njit(cache=True, nogil=True)
def _graded_steps(colour, grades, counts):
    """Grade of the step to four neighbours, uint16 (H, W, 4), counted; ``NO_EDGE`` beyond the image."""
    rows, columns = colour.shape[:2]
    for y in range(rows):
        for x in range(columns):
            for way in range(4):
                v, u = y + OFFSETS[way][0], x + OFFSETS[way][1]
                if v >= rows or u < 0 or u >= columns:
                    grades[y, x, way] = NO_EDGE
                    continue
                grade = np.uint16(_step(colour, y, x, v, u) * np.float32(GRADES))
                grades[y, x, way] = grade
                counts[grade + 1] += 1


@njit(cache=True, nogil=True)
def _ascending(grades, counts, order):
    """Edges (4 pixel + way, int32) by ascending grade; counts of lower grades are used up."""
    flat = grades.reshape(-1)
    for e in range(flat.size):
        grade = flat[e]
        if grade != NO_EDGE:
            order[counts[grade]] = e
            counts[grade] += 1


@njit(cache=True, nogil=True)
def superpixels(colour, breadth, smallest, home):
    """Felzenszwalb and Huttenlocher's segmentation: colour float32 (H, W, C) -> home int32 (H W), roots."""
    rows, columns = colour.shape[:2]
    grades = np.empty((rows, columns, 4), np.uint16)
    counts = np.zeros(NO_EDGE + 1, np.int64)
    _graded_steps(colour, grades, counts)
    counts = np.cumsum(counts)
    count = counts[NO_EDGE]
    order = np.empty(count, np.int32)
    _ascending(grades, counts, order)
    beyond = np.array([1, columns, columns + 1, columns - 1])
    size = np.ones(rows * columns, np.int32)
    limit = np.full(rows * columns, breadth, np.float32)
    for i in range(rows * columns):
        home[i] = i
    for e in order:
        a, b = _root(home, e >> 2), _root(home, (e >> 2) + beyond[e & 3])
        if a != b:
            way, i = e & 3, e >> 2
            y, x = i // columns, i % columns
            weight = _step(colour, y, x, y + OFFSETS[way][0], x + OFFSETS[way][1])
            if weight <= limit[a] and weight <= limit[b]:
                home[b] = a
                size[a] += size[b]
                limit[a] = weight + breadth / size[a]
    for e in order:
        a, b = _root(home, e >> 2), _root(home, (e >> 2) + beyond[e & 3])
        if a != b and (size[a] < smallest or size[b] < smallest):
            home[b] = a
            size[a] += size[b]
    for i in range(rows * columns):
        home[i] = _root(home, i)


@njit(cache=True, nogil=True)
def listed(labels, starts, order):
    """Pixels region by region: labels int32 (H, W) -> starts int64 (R + 1,), order int64 (H W,)."""
    rows, columns = labels.shape
    for y in range(rows):
        for x in range(columns):
            starts[labels[y, x] + 1] += 1
    for r in range(starts.size - 1):
        starts[r + 1] += starts[r]
    place = starts[:-1].copy()
    for y in range(rows):
        for x in range(columns):
            r = labels[y, x]
            order[place[r]] = (y << HALF) | x
            place[r] += 1


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
def fitted(disparity, votes, starts, order, settings, planes, support, share):
    """A robust plane for each region.

    Hypotheses through three voters (every fourth level), scored by sum w max(0, 1 - r²); then reweighted
    least squares by Tukey's weight at 1.5 px with a ridge on the slopes.

    disparity, votes: float32 (H, W); settings: (hypotheses, steepest, reach, Tukey's width, ridge, about how
    many voters a hypothesis is scored on); planes float64 (R, 3); support float32 (R,): summed votes; share: of
    votes within reach.
    """
    hypotheses, steepest, reach, width, ridge, most = settings
    voters = np.empty((4, order.size), np.float32)
    xs, ys, ds, ws = voters[0], voters[1], voters[2], voters[3]
    few = np.empty((4, order.size), np.float32)
    found = np.zeros(3)
    for r in range(starts.size - 1):
        count, total = 0, 0.0
        for i in range(starts[r], starts[r + 1]):
            y, x = order[i] >> HALF, order[i] & MASK
            if votes[y, x] > 0:
                xs[count], ys[count], ds[count], ws[count] = x, y, disparity[y, x], votes[y, x]
                total += votes[y, x]
                count += 1
        support[r] = total
        share[r] = 0.0
        if count < 3:
            continue
        stride = max(1, count // np.int64(most))
        scored = 0
        for i in range(0, count, stride):
            few[0, scored], few[1, scored], few[2, scored], few[3, scored] = xs[i], ys[i], ds[i], ws[i]
            scored += 1
        _best_of(xs[:count], ys[:count], ds[:count], few[:, :scored], (hypotheses, steepest, reach), found)
        _polished(xs[:count], ys[:count], ds[:count], ws[:count], (width, ridge, steepest), found)
        near = 0.0
        for i in range(count):
            if abs(found[0] * xs[i] + found[1] * ys[i] + found[2] - ds[i]) < reach:
                near += ws[i]
        share[r] = near / total
        planes[r] = found


@njit(cache=True, nogil=True, fastmath=True)
def _score(few, a, b, c, scale):
    """Sum of w max(0, 1 - (r / reach)²) over (x, y, disparity, votes)."""
    xs, ys, ds, ws = few[0], few[1], few[2], few[3]
    score = np.float32(0)
    for i in range(xs.size):
        off = (a * xs[i] + b * ys[i] + c - ds[i]) * scale
        score += ws[i] * max(np.float32(0), np.float32(1) - off * off)
    return score


@njit(cache=True, nogil=True)
def _best_of(xs, ys, ds, few, settings, found):
    """The best of planes through three voters each, drawn by a fixed sequence; every fourth is level."""
    hypotheses, steepest, reach = settings
    state = np.uint32(12345)
    best = np.float32(-1)
    three = np.zeros(3, np.int64)
    for h in range(np.int64(hypotheses)):
        for j in range(3):
            state = np.uint32(state * np.uint32(1664525) + np.uint32(1013904223))
            three[j] = np.int64(state >> np.uint32(8)) % xs.size
        i, j, k = three
        a, b, c = np.float32(0), np.float32(0), ds[i]
        if h % 4:
            x1, y1, d1 = xs[j] - xs[i], ys[j] - ys[i], ds[j] - ds[i]
            x2, y2, d2 = xs[k] - xs[i], ys[k] - ys[i], ds[k] - ds[i]
            det = x1 * y2 - x2 * y1
            if det == 0:
                continue
            a, b = (d1 * y2 - d2 * y1) / det, (x1 * d2 - x2 * d1) / det
            if abs(a) > steepest or abs(b) > steepest:
                continue
            c = ds[i] - a * xs[i] - b * ys[i]
        score = _score(few, a, b, c, np.float32(1 / reach))
        if score > best:
            best = score
            found[0], found[1], found[2] = a, b, c


@njit(cache=True, nogil=True)
def _polished(xs, ys, ds, ws, settings, plane):
    """Four steps of reweighted least squares, in place."""
    width, ridge, steepest = settings
    matrix, side = np.zeros((3, 3)), np.zeros(3)
    mx, my = np.sum(ws * xs) / np.sum(ws), np.sum(ws * ys) / np.sum(ws)
    for _ in range(4):
        sxx = sxy = syy = sx = sy = s = sxd = syd = sd = 0.0
        for i in range(xs.size):
            off = plane[0] * xs[i] + plane[1] * ys[i] + plane[2] - ds[i]
            t = 1 - (off / width) ** 2
            w = ws[i] * t * t if t > 0 else 0.0
            x, y = xs[i] - mx, ys[i] - my
            sxx += w * x * x
            sxy += w * x * y
            syy += w * y * y
            sx += w * x
            sy += w * y
            s += w
            sxd += w * x * ds[i]
            syd += w * y * ds[i]
            sd += w * ds[i]
        if s <= 0:
            return
        matrix[0, 0], matrix[0, 1], matrix[0, 2] = sxx + ridge, sxy, sx
        matrix[1, 1], matrix[1, 2], matrix[2, 2] = syy + ridge, sy, s
        side[0], side[1], side[2] = sxd, syd, sd
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
def energies(disparity, votes, right, views, listing, planes, candidates, span, prices, costs, coverage):
    """What each candidate plane costs each region, in [0, 1], and how it suits the region's own voters.

    disparity, votes, right: float32 (H, W), right NaN where unknown; views: census words of both, uint64;
    listing: (starts, order); candidates: (region, plane) int32 (M, 2); span: least and largest disparity;
    prices: of a pixel without a vote that the right view cannot see, outside it or hidden;
    costs float32 (M,); coverage float32 (M, 2): share of votes within 1 px, votes a pixel.
    """
    here, there_words = views
    starts, order = listing
    low, high = span
    outside, occluded = prices
    for m in range(candidates.shape[0]):
        r = candidates[m, 0]
        a, b, c = planes[candidates[m, 1]]
        total, weights, near, voted = 0.0, 0.0, 0.0, 0.0
        stride = max(1, (starts[r + 1] - starts[r]) // 500)
        looked = 0
        for i in range(starts[r], starts[r + 1], stride):
            y, x = order[i] >> HALF, order[i] & MASK
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
            elif sight == OUTSIDE:
                total += 0.5 * outside
            elif sight == OCCLUDED:
                total += 0.5 * occluded
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
