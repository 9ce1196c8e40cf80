# mypy: ignore-errors
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
def _medians(members, count, network, middle):
    """The median of the first ``count`` of the sorted members, all else being +inf; members are sorted."""
    _sort(members, network)
    for x in range(middle.size):
        n = count[x]
        if n > 0:
            middle[x] = np.float32(0.5) * (members[(n - 1) // 2, x] + members[n // 2, x])


@njit(cache=True, nogil=True)
def cohere(predicted, own, trust, prior, reached, neighbours, limit, value, worth, spread, both, verdict):
    """Eqs. 5.31 and 5.52, corrected, with variances.

    Parameters: ``predicted`` float32 (H, W, C), what each pixel predicts for its neighbours, NaN nothing, and
    ``trust`` float32 (H, W) what that is worth; ``own`` what stands where nobody can judge; ``prior`` the map's
    value, NaN unknown; ``reached`` the links, of which the first ``neighbours`` count; ``limit`` is rho. Sets
    ``value`` (H, W, C), ``worth`` (H, W) the mean trust of the neighbours (an absent one has none),
    ``spread`` var(F), ``both`` var(F with the map's), NaN where there is none, and ``verdict`` uint8.
    """
    rows, columns, channels = predicted.shape
    size = neighbours + 1
    network = SHORT if size <= 5 else NETWORK
    members = np.empty((channels, size, columns), np.float32)
    sorted_ = np.empty((9, columns), np.float32)
    kept = np.empty((channels, columns), np.float32)
    count = np.empty(columns, np.int64)
    union = np.empty(columns, np.int64)
    first, second = np.empty(columns, np.float32), np.empty(columns, np.float32)
    nothing = np.float32(np.nan)
    far = np.float32(np.inf)
    for y in range(rows):
        _gather(predicted, trust, reached, neighbours, y, members, count, worth)
        _variance(members, count, prior[y], first, second)
        for x in range(columns):
            known = not np.isnan(prior[y, x, 0])
            n = count[x]
            spread[y, x] = first[x] if n > 1 else nothing
            both[y, x] = second[x] if n > 1 and known else nothing
            union[x] = n
            if n < 2:
                verdict[y, x] = ALONE
                worth[y, x] = trust[y, x]
            elif first[x] > limit:
                verdict[y, x] = REJECTED
            elif known and second[x] <= limit:
                verdict[y, x] = AGREED
                for c in range(channels):
                    members[c, n, x] = prior[y, x, c]
                union[x] = n + 1
            else:
                verdict[y, x] = REPLACED
        for c in range(channels):
            for k in range(size):
                for x in range(columns):
                    sorted_[k, x] = members[c, k, x] if k < union[x] else far
            _medians(sorted_[:size] if size <= 5 else sorted_, union, network, kept[c])
        for x in range(columns):
            judged = verdict[y, x]
            if judged == ALONE:
                value[y, x] = own[y, x]
            elif judged == REJECTED:
                value[y, x] = prior[y, x]
            elif channels == 1:
                value[y, x, 0] = kept[0, x]
            else:
                best, nearest = 0, far
                for k in range(union[x]):
                    distance = np.float32(0)
                    for c in range(channels):
                        off = members[c, k, x] - kept[c, x]
                        distance += off * off
                    if distance < nearest:
                        best, nearest = k, distance
                for c in range(channels):
                    value[y, x, c] = members[c, best, x]


@njit(cache=True, nogil=True)
def _gather(predicted, trust, reached, neighbours, y, members, count, worth):
    """The predictions for the pixels of row ``y``, first come first: ``members`` (C, K, W) and ``count``."""
    columns, channels = predicted.shape[1:]
    for x in range(columns):
        bits = reached[y, x]
        n, linked, total = 0, 0, np.float32(0)
        for k in range(neighbours):
            if not bits >> k & 1:
                continue
            linked += 1
            v, u = y + ROWS[k], x + COLUMNS[k]
            if np.isnan(predicted[v, u, 0]):
                continue
            for c in range(channels):
                members[c, n, x] = predicted[v, u, c]
            total += trust[v, u]
            n += 1
        count[x] = n
        worth[y, x] = total / np.float32(max(linked, 1))


@njit(cache=True, nogil=True)
def _variance(members, count, prior, first, second):
    """Mean over the channels of the variance of the members, and of the members with the map's value."""
    channels, _, columns = members.shape
    for x in range(columns):
        n = count[x]
        alone, united = np.float32(0), np.float32(0)
        if n > 1:
            for c in range(channels):
                total = np.float32(0)
                for k in range(n):
                    total += members[c, k, x]
                mean = total / np.float32(n)
                squares = np.float32(0)
                for k in range(n):
                    off = members[c, k, x] - mean
                    squares += off * off
                alone += squares / np.float32(n)
                off = prior[x, c] - mean
                united += (squares + off * off * np.float32(n) / np.float32(n + 1)) / np.float32(n + 1)
        first[x], second[x] = alone / np.float32(channels), united / np.float32(channels)


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
