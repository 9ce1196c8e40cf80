# mypy: ignore-errors
"""Kernels of neighbourhoods that end at boundaries."""

from __future__ import annotations

import numpy as np
from numba import njit

ROWS = np.array([-1, 0, 1, 0, -1, -1, 1, 1])
COLUMNS = np.array([0, 1, 0, -1, -1, 1, 1, -1])


@njit(cache=True, nogil=True)
def links(lines, reached):
    """Sets ``reached`` uint8 (H, W): bit k where neighbour k is on the same side of ``lines`` bool (H, W)."""
    rows, columns = lines.shape
    for y in range(rows):
        for x in range(columns):
            bits = 0
            if not lines[y, x]:
                for k in range(8):
                    v, u = y + ROWS[k], x + COLUMNS[k]
                    if v < 0 or v >= rows or u < 0 or u >= columns or lines[v, u]:
                        continue
                    if k >= 4 and lines[y, u] and lines[v, x]:
                        continue
                    bits |= 1 << k
            reached[y, x] = bits


@njit(cache=True, nogil=True)
def owners(labels, field, owned):
    """Sets ``owned`` int32 (H, W) to the labels, each 0 taking that of the neighbour whose value is nearest.

    Where its own value or all neighbours' are unknown, the first of them; 0 stays where there is no neighbour.
    """
    rows, columns = labels.shape
    for y in range(rows):
        for x in range(columns):
            owned[y, x] = labels[y, x]
            if labels[y, x] != 0:
                continue
            nearest = np.float32(np.inf)
            for k in range(8):
                v, u = y + ROWS[k], x + COLUMNS[k]
                if v < 0 or v >= rows or u < 0 or u >= columns or labels[v, u] == 0:
                    continue
                off = abs(field[v, u] - field[y, x])
                if owned[y, x] == 0 or off < nearest:
                    owned[y, x] = labels[v, u]
                    nearest = nearest if np.isnan(off) else off


@njit(cache=True, nogil=True)
def links_of(owned, reached):
    """Sets ``reached`` uint8 (H, W): bit k where neighbour k has the same owner, not 0."""
    rows, columns = owned.shape
    for y in range(rows):
        for x in range(columns):
            bits = 0
            label = owned[y, x]
            if label != 0:
                for k in range(8):
                    v, u = y + ROWS[k], x + COLUMNS[k]
                    if 0 <= v < rows and 0 <= u < columns and owned[v, u] == label:
                        bits |= 1 << k
            reached[y, x] = bits


@njit(cache=True, nogil=True)
def mean(values, reached, neighbours, average, count):
    """Mean of the known among the first ``neighbours`` that are reached, and their number."""
    rows, columns = values.shape
    for y in range(rows):
        for x in range(columns):
            total, known = np.float32(0), 0
            bits = reached[y, x]
            for k in range(neighbours):
                if bits >> k & 1:
                    value = values[y + ROWS[k], x + COLUMNS[k]]
                    if not np.isnan(value):
                        total += value
                        known += 1
            average[y, x] = total / np.float32(known) if known > 0 else np.float32(np.nan)
            count[y, x] = known


@njit(cache=True, nogil=True)
def bend(values, reached, found):
    """The quarter-Laplacian of ``values``: the mean, over whole axes, of pair means less the value."""
    rows, columns = values.shape
    half = np.float32(0.5)
    for y in range(rows):
        for x in range(columns):
            bits = reached[y, x]
            total, axes = np.float32(0), 0
            if bits & 1 and bits & 4:
                one = half * (values[y - 1, x] + values[y + 1, x]) - values[y, x]
                if not np.isnan(one):
                    total += one
                    axes += 1
            if bits & 2 and bits & 8:
                one = half * (values[y, x - 1] + values[y, x + 1]) - values[y, x]
                if not np.isnan(one):
                    total += one
                    axes += 1
            found[y, x] = total / np.float32(axes) if axes > 0 else np.float32(0)


@njit(cache=True, nogil=True)
def bend_of_slopes(slopes, reached, found):
    """The same from slopes (H, W, 2).

    A step to a neighbour is the mean of the two slopes, so a pair mean exceeds the value by a quarter of the
    difference of the outer slopes.
    """
    rows, columns = slopes.shape[:2]
    quarter = np.float32(0.25)
    for y in range(rows):
        for x in range(columns):
            bits = reached[y, x]
            total, axes = np.float32(0), 0
            if bits & 1 and bits & 4:
                one = quarter * (slopes[y + 1, x, 1] - slopes[y - 1, x, 1])
                if not np.isnan(one):
                    total += one
                    axes += 1
            if bits & 2 and bits & 8:
                one = quarter * (slopes[y, x + 1, 0] - slopes[y, x - 1, 0])
                if not np.isnan(one):
                    total += one
                    axes += 1
            found[y, x] = total / np.float32(axes) if axes > 0 else np.float32(np.nan)
