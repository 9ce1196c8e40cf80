# mypy: ignore-errors
"""Kernels of the strategies: neighbourhoods that end at boundaries, and sums along lines."""

from __future__ import annotations

import numpy as np
from numba import njit

ROWS = np.array([-1, 0, 1, 0])
COLUMNS = np.array([0, 1, 0, -1])


@njit(cache=True, nogil=True)
def _support(value, values, weights, agree):
    """Σ over the labels (K,) of a neighbour: weight times compatibility of its value with ``value``."""
    total = 0.0
    for other in range(values.size):
        if weights[other] > 0:
            apart = (value - values[other]) / agree
            total += weights[other] * (2 * 2.0 ** (-apart * apart) - 1)
    return total


@njit(cache=True, nogil=True)
def relax(values, weights, reached, agree, after):
    """One parallel round of Eqs. 2.2 and 2.3: ``weights`` float64 (K, H, W) to ``after``."""
    labels, rows, columns = values.shape
    for y in range(rows):
        for x in range(columns):
            bits, total = reached[y, x], 0.0
            for label in range(labels):
                change, count = 0.0, 0
                for k in range(4):
                    if bits >> k & 1:
                        v, u = y + ROWS[k], x + COLUMNS[k]
                        if weights[:, v, u].sum() > 0:
                            change += _support(values[label, y, x], values[:, v, u], weights[:, v, u], agree)
                            count += 1
                grown = weights[label, y, x] * (1 + change / max(count, 1))
                after[label, y, x] = grown
                total += grown
            for label in range(labels):
                if total > 0:
                    after[label, y, x] /= total
                else:
                    after[label, y, x] = weights[label, y, x]


@njit(cache=True, nogil=True)
def _slope(step, stiffness, line, sharpness):
    """Half the derivative of Blake and Zisserman's neighbour function at ``step``: a spring that breaks."""
    size = abs(step)
    breaks = np.sqrt(line * (2 / sharpness + 1 / stiffness))
    bends = line / (stiffness * breaks)
    if size < bends:
        return stiffness * step
    if size < breaks:
        return 0.5 * sharpness * (breaks - size) * np.sign(step)
    return 0.0


@njit(cache=True, nogil=True)
def weak_membrane(said, weight, reached, spring, rounds, field):
    """Descends on Σ w (f − d)² + Σ g(f − f'), ``spring`` = (λ², α, c) of g; ``field`` float64 (H, W) in place.

    Successive over-relaxation from above left, from below right in turn, stopped by rounds or at 1e-5.
    """
    rows, columns = said.shape
    stiffness, line, sharpness = spring
    for turn in range(rounds):
        largest = 0.0
        for i in range(rows * columns):
            j = i if turn % 2 == 0 else rows * columns - 1 - i
            y, x = j // columns, j % columns
            bits, here = reached[y, x], field[y, x]
            gradient, most = weight[y, x] * (here - said[y, x]), np.float64(weight[y, x])
            for k in range(4):
                if bits >> k & 1:
                    gradient += _slope(here - field[y + ROWS[k], x + COLUMNS[k]], stiffness, line, sharpness)
                    most += stiffness
            if most > 0:
                step = 1.4 * gradient / most
                field[y, x] = here - step
                largest = max(largest, abs(step))
        if largest < 1e-5:
            return


@njit(cache=True, nogil=True)
def broken(field, reached, limit, right, below):
    """Sets where the spring to the right, and to the one below, is broken: the step is above ``limit``."""
    rows, columns = field.shape
    for y in range(rows):
        for x in range(columns):
            bits = reached[y, x]
            right[y, x] = bits >> 1 & 1 and abs(field[y, x + 1] - field[y, x]) > limit
            below[y, x] = bits >> 2 & 1 and abs(field[y + 1, x] - field[y, x]) > limit


@njit(cache=True, nogil=True)
def _left_over(sums, first, last, lines):
    """(weighted squares left, value at the middle, slope, middle) of the best fit to first ≤ i < last."""
    w = sums[0, last] - sums[0, first]
    if w <= 0:
        return 0.0, np.nan, 0.0, 0.0
    d, dd = sums[1, last] - sums[1, first], sums[2, last] - sums[2, first]
    mean, squares = d / w, dd - d * d / w
    if not lines:
        return max(squares, 0.0), mean, 0.0, 0.0
    x, xx, xd = (sums[3, last] - sums[3, first], sums[4, last] - sums[4, first], sums[5, last] - sums[5, first])
    spread, joint = xx - x * x / w, xd - x * d / w
    if spread <= 1e-9 * w:
        return max(squares, 0.0), mean, 0.0, x / w
    slope = joint / spread
    return max(squares - slope * joint, 0.0), mean, slope, x / w


@njit(cache=True, nogil=True)
def _sums(said, weight, sums):
    """Running sums of w, w d, w d², w x, w x², w x d; (6, N + 1)."""
    for i in range(said.size):
        w, d = np.float64(weight[i]), np.float64(said[i])
        sums[0, i + 1] = sums[0, i] + w
        sums[1, i + 1] = sums[1, i] + w * d
        sums[2, i + 1] = sums[2, i] + w * d * d
        sums[3, i + 1] = sums[3, i] + w * i
        sums[4, i + 1] = sums[4, i] + w * i * i
        sums[5, i + 1] = sums[5, i] + w * i * d


@njit(cache=True, nogil=True)
def _shortest(sums, price, lines, best, cut):
    """Dynamic programming over breakpoints, those pruned that can never win again (PELT, exact)."""
    count = best.size - 1
    open_, number = np.zeros(count + 1, np.int64), 1
    best[0] = 0.0
    for last in range(1, count + 1):
        best[last] = np.inf
        bits = np.empty(number)
        for k in range(number):
            first = open_[k]
            squares = _left_over(sums, first, last, lines)[0]
            bits[k] = best[first] + price[first] + squares * 0.5 * np.log2(np.e)
            if bits[k] < best[last]:
                best[last], cut[last] = bits[k], first
        if last == count:
            return
        kept = 0
        for k in range(number):
            if bits[k] < best[last] + price[last]:
                open_[kept] = open_[k]
                kept += 1
        open_[kept] = last
        number = kept + 1


@njit(cache=True, nogil=True)
def describe(said, weight, price, lines, fitted):
    """The shortest description of each row by runs of constants, or of lines; returns the bits.

    ``price`` float64 (H, W): the bits of a run that begins there; ``fitted`` (H, W) is set.
    """
    rows, columns = said.shape
    total = 0.0
    sums, best = np.zeros((6, columns + 1)), np.empty(columns + 1)
    cut = np.zeros(columns + 1, np.int64)
    for y in range(rows):
        _sums(said[y], weight[y], sums)
        _shortest(sums, price[y], lines, best, cut)
        total += best[columns]
        last = columns
        while last > 0:
            first = cut[last]
            _, mean, slope, middle = _left_over(sums, first, last, lines)
            for x in range(first, last):
                fitted[y, x] = mean + slope * (x - middle)
            last = first
    return total
