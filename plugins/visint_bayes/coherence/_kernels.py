# mypy: ignore-errors
# ruff: noqa: PLR0917, PLR1714 - kernels take what they need; numba knows no mixed tuples
"""The kernel of coherence: variances and medians of small sets of neighbours, a row at a time."""

from __future__ import annotations

import numpy as np
from numba import njit

ROWS = np.array([-1, 0, 1, 0, -1, -1, 1, 1])
COLUMNS = np.array([0, 1, 0, -1, -1, 1, 1, -1])
# Sorting networks for nine values (Floyd, 25 comparators) and for five; places without a value hold +inf.
NETWORK = np.array(
    [
        (0, 1), (3, 4), (6, 7), (1, 2), (4, 5), (7, 8), (0, 1), (3, 4), (6, 7), (2, 5), (0, 3), (1, 4), (5, 8),
        (3, 6), (4, 7), (2, 5), (0, 3), (1, 4), (5, 7), (2, 6), (1, 3), (4, 6), (2, 4), (5, 6), (2, 3),
    ]
)  # fmt: skip
SHORT = np.array([(0, 1), (3, 4), (2, 4), (2, 3), (1, 4), (0, 3), (0, 2), (1, 3), (1, 2)])

REJECTED, REPLACED, AGREED, ALONE = 0, 1, 2, 3


@njit(cache=True, nogil=True, fastmath={"nnan", "nsz"})
def _sort(members, network):
    """Sorts ``members`` (K, W) along the first axis; no NaN."""
    for step in range(network.shape[0]):
        low, high = members[network[step, 0]], members[network[step, 1]]
        for x in range(low.size):
            a, b = low[x], high[x]
            low[x] = min(a, b)
            high[x] = max(a, b)


@njit(cache=True, nogil=True)
def cohere(predicted, own, told, prior, reached, neighbours, limit, value, kept, spread, both, verdict):
    """Eqs. 5.31 and 5.52, corrected, with variances.

    Parameters: ``predicted`` float32 (C, H, W), what each pixel predicts for its neighbours, NaN nothing, and
    ``told`` (2, H, W) the reliability and sigma of that; ``own`` (H, W, C) what stands where nobody can judge;
    ``prior`` (C, H, W) the map's value, NaN unknown; ``reached`` the links, of which the first ``neighbours``
    count; ``limit`` is rho. Sets ``value`` (H, W, C), ``kept`` (2, H, W) the neighbours' mean reliability (an
    absent one has none) and sigma, ``spread`` var(F), ``both`` var(F with the map's), NaN where there is none,
    and ``verdict`` uint8.
    """
    channels, rows, columns = predicted.shape
    size = neighbours + 1
    network = SHORT if size <= 5 else NETWORK
    members = np.empty((channels, size, columns), np.float32)  # 0 where absent
    there = np.zeros((size, columns), np.float32)  # 1 where a member is; the map's value is the last
    ordered = np.empty((size, columns), np.float32)
    middle = np.empty((channels, columns), np.float32)
    count = np.empty(columns, np.float32)
    alone, united = np.empty(columns, np.float32), np.empty(columns, np.float32)
    mean, squares = np.empty(columns, np.float32), np.empty(columns, np.float32)
    best, nearest = np.empty(columns, np.int32), np.empty(columns, np.float32)
    nothing = np.float32(np.nan)
    far = np.float32(np.inf)
    for y in range(rows):
        _gather(predicted, told, reached, neighbours, y, members, there, count, kept)
        alone[:] = 0
        united[:] = 0
        for c in range(channels):
            _variance(members[c], there, count, prior[c, y], mean, squares, alone, united)
        for x in range(columns):
            n = count[x]
            first, second = alone[x] / np.float32(channels), united[x] / np.float32(channels)
            known = not np.isnan(prior[0, y, x])
            spread[y, x] = first if n > 1 else nothing
            both[y, x] = second if n > 1 and known else nothing
            there[neighbours, x] = 0
            if n < 2:
                verdict[y, x] = ALONE
                kept[0, y, x] = told[0, y, x]
                kept[1, y, x] = told[1, y, x]
            elif first > limit:
                verdict[y, x] = REJECTED
            elif known and second <= limit:
                verdict[y, x] = AGREED
                there[neighbours, x] = 1
                count[x] = n + 1
            else:
                verdict[y, x] = REPLACED
        for c in range(channels):
            members[c, neighbours] = prior[c, y]
            for k in range(size):
                for x in range(columns):
                    ordered[k, x] = members[c, k, x] if there[k, x] > 0 else far
            _sort(ordered, network)
            for x in range(columns):
                n = max(np.int64(count[x]), 1)
                middle[c, x] = np.float32(0.5) * (ordered[(n - 1) // 2, x] + ordered[n // 2, x])
        if channels > 1:
            _nearest(members, there, middle, squares, best, nearest)
        for x in range(columns):
            judged = verdict[y, x]
            for c in range(channels):
                if judged == ALONE:
                    value[y, x, c] = own[y, x, c]
                elif judged == REJECTED:
                    value[y, x, c] = prior[c, y, x]
                elif channels == 1:
                    value[y, x, c] = middle[c, x]
                else:
                    value[y, x, c] = members[c, best[x], x]


@njit(cache=True, nogil=True)
def _gather(predicted, told, reached, neighbours, y, members, there, count, kept):
    """The predictions for the pixels of row ``y`` by neighbour, 0 if there is none, and what they are worth."""
    channels, _, columns = predicted.shape
    count[:] = 0
    worth, width = kept[0, y], kept[1, y]
    worth[:] = 0
    width[:] = 0
    linked = np.zeros(columns, np.float32)
    one, nil = np.float32(1), np.float32(0)
    for k in range(neighbours):
        v, across = y + ROWS[k], COLUMNS[k]
        bit = np.uint8(1 << k)
        there[k] = 0
        for c in range(channels):
            members[c, k] = 0
        if v < 0 or v >= predicted.shape[1]:
            continue
        low, high = max(0, -across), min(columns, columns - across)
        if high <= low:
            continue
        open_, here = reached[y, low:high], there[k, low:high]  # slices: an index x + across hinders SIMD
        values = predicted[0, v, low + across : high + across]
        sure, spread = told[0, v, low + across : high + across], told[1, v, low + across : high + across]
        seen, total = linked[low:high], count[low:high]
        sums, widths = worth[low:high], width[low:high]
        for x in range(high - low):
            link = one if open_[x] & bit else nil
            seen[x] += link
            speaks = link if values[x] == values[x] else nil
            here[x] = speaks
            total[x] += speaks
            sums[x] += sure[x] if speaks > 0 else nil
            widths[x] += spread[x] if speaks > 0 else nil
        for c in range(channels):
            into, values = members[c, k, low:high], predicted[c, v, low + across : high + across]
            for x in range(high - low):
                into[x] = values[x] if here[x] > 0 else nil
    for x in range(columns):
        worth[x] /= max(linked[x], one)
        width[x] /= max(count[x], one)


@njit(cache=True, nogil=True)
def _variance(members, there, count, prior, mean, squares, alone, united):
    """Adds the variance of the members to ``alone``, and that of the members with the map's to ``united``."""
    size, columns = members.shape
    one = np.float32(1)
    mean[:] = 0
    squares[:] = 0
    for k in range(size - 1):
        for x in range(columns):
            mean[x] += members[k, x]
    for x in range(columns):
        mean[x] /= max(count[x], one)
    for k in range(size - 1):
        for x in range(columns):
            off = members[k, x] - mean[x]
            squares[x] += there[k, x] * off * off
    for x in range(columns):
        n = max(count[x], one)
        off = prior[x] - mean[x]
        alone[x] += squares[x] / n
        united[x] += (squares[x] + off * off * n / (n + one)) / (n + one)


@njit(cache=True, nogil=True)
def _nearest(members, there, middle, distance, best, nearest):
    """Sets ``best``: the member nearest to the medians of the components."""
    channels, size, columns = members.shape
    far = np.float32(np.inf)
    nearest[:] = far
    best[:] = 0
    for k in range(size):
        distance[:] = 0
        for c in range(channels):
            for x in range(columns):
                off = members[c, k, x] - middle[c, x]
                distance[x] += off * off
        for x in range(columns):
            length = distance[x] if there[k, x] > 0 else far
            closer = length < nearest[x]
            best[x] = k if closer else best[x]
            nearest[x] = length if closer else nearest[x]


@njit(cache=True, nogil=True)
def carried_back(back, field, found):
    """The other view's disparity ``back`` at the match x - ``field`` of each pixel, linear; NaN outside."""
    rows, columns = field.shape
    for y in range(rows):
        for x in range(columns):
            place = np.float32(x) - field[y, x]
            if not (place >= 0 and place <= columns - 1):
                found[y, x] = np.float32(np.nan)
                continue
            i = np.int64(place)
            t = place - np.float32(i)
            found[y, x] = (np.float32(1) - t) * back[y, i] + t * back[y, min(i + 1, columns - 1)]


@njit(cache=True, nogil=True)
def _ray(lines, labels, field, sure, y, x, down, across, reach, found):
    """What lies on one side of a line: fills ``found`` with mean place, mean value, slope and sureness.

    Goes from (y, x) in steps of (down, across), over at most one more pixel of the line, then along up to
    ``reach`` pixels of one label. Gives that label, 0 if there are fewer than two of them.
    """
    rows, columns = field.shape
    label, n = 0, 0
    first, last = np.float32(0), np.float32(0)
    where, total, trust = 0.0, 0.0, 0.0
    for step in range(1, reach + 2):
        v, u = y + step * down, x + step * across
        if v < 0 or v >= rows or u < 0 or u >= columns or np.isnan(field[v, u]):
            break
        if lines[v, u]:
            if n > 0 or step > 1:
                break
            continue
        if n == 0:
            label, first = labels[v, u], field[v, u]
        elif labels[v, u] != label or n == reach:
            break
        last = field[v, u]
        n += 1
        where += step
        total += field[v, u]
        trust += sure[v, u]
    if n < 2:
        return 0
    found[0], found[1], found[2], found[3] = where / n, total / n, (last - first) / (n - 1), trust / n
    return label


@njit(cache=True, nogil=True)
def across_lines(lines, labels, field, sure, reach, count, step, bend, trust):
    """Adds up, by pair of labels a < b, what the field does across the lines between them.

    ``step`` (N, N): by how much the two sides, each continued straight to the middle, miss each other;
    ``bend``: by how much the slope changes, per pixel, going from a to b; ``trust`` the smaller sureness of the
    two sides; ``count`` how many were looked at.
    """
    rows, columns = lines.shape
    before, after = np.zeros(4), np.zeros(4)
    for y in range(rows):
        for x in range(columns):
            if not lines[y, x]:
                continue
            for way in range(4):
                down, across = (0, 1, 1, 1)[way], (1, 0, 1, -1)[way]
                a = _ray(lines, labels, field, sure, y, x, -down, -across, reach, before)
                if a == 0:
                    continue
                b = _ray(lines, labels, field, sure, y, x, down, across, reach, after)
                if b == 0 or b == a:
                    continue
                # slopes are told away from the line, so going from before to after the first has the other sign
                miss = (after[1] - after[2] * after[0]) - (before[1] - before[2] * before[0])
                turn = after[2] + before[2]
                sign = 1.0
                if a > b:
                    a, b, sign = b, a, -1.0
                count[a, b] += 1
                step[a, b] += sign * miss
                bend[a, b] += turn
                trust[a, b] += min(before[3], after[3])


@njit(cache=True, nogil=True)
def still_between(lines, labels, open_, kept):
    """Sets ``kept`` where a line has, within two pixels, two labels whose border is not ``open_`` (N, N)."""
    rows, columns = lines.shape
    for y in range(rows):
        for x in range(columns):
            kept[y, x] = False
            if not lines[y, x]:
                continue
            for v in range(max(y - 2, 0), min(y + 3, rows)):
                for u in range(max(x - 2, 0), min(x + 3, columns)):
                    a = labels[v, u]
                    if a == 0 or kept[y, x]:
                        continue
                    for q in range(v, min(y + 3, rows)):
                        for p in range(max(x - 2, 0), min(x + 3, columns)):
                            b = labels[q, p]
                            if b != 0 and b != a and not open_[min(a, b), max(a, b)]:
                                kept[y, x] = True
