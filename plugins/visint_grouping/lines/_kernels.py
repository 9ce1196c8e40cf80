# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Loops over the pixels of lines: thinning, tracing, extension, corners, and diffusion between walls."""

from __future__ import annotations

import numpy as np
from numba import njit

# The eight neighbours (row, column) in order around a pixel, ending at the upper left.
CIRCLE = np.array([[-1, 0], [-1, 1], [0, 1], [1, 1], [1, 0], [1, -1], [0, -1], [-1, -1]])


@njit(cache=True, nogil=True)
def _neighbours(lines, y, x):
    """(set pixels among the eight, 8-connected groups they form: Hilditch's number)."""
    rows, columns = lines.shape
    ring = 0
    count, groups = 0, 0
    for k in range(8):
        v, u = y + CIRCLE[k, 0], x + CIRCLE[k, 1]
        if 0 <= v < rows and 0 <= u < columns and lines[v, u]:
            ring |= 1 << k
            count += 1
    for k in (0, 2, 4, 6):
        if not ring >> k & 1 and (ring >> (k + 1) & 1 or ring >> ((k + 2) % 8) & 1):
            groups += 1
    return count, groups


@njit(cache=True, nogil=True)
def thin(lines):
    """Takes away pixels of ``lines`` (bool (H, W), changed in place) that only make a line thick.

    From left, right, above and below in turn, three times: a pixel open to that side goes if its neighbours
    hang together without it (two to six in one group). Which are open is settled before a pass, so
    a pass takes one layer, and a line is not eaten up from its end.
    """
    rows, columns = lines.shape
    open_ = np.zeros((rows, columns), np.bool_)
    for turn in range(12):
        down = (turn % 4 == 3) - (turn % 4 == 2)
        across = (turn % 4 == 1) - (turn % 4 == 0)
        for y in range(rows):
            for x in range(columns):
                v, u = y + down, x + across
                inside = 0 <= v < rows and 0 <= u < columns
                open_[y, x] = lines[y, x] and not (inside and lines[v, u])
        for y in range(rows):
            for x in range(columns):
                if open_[y, x]:
                    count, runs = _neighbours(lines, y, x)
                    if runs == 1 and 2 <= count <= 6:
                        lines[y, x] = False


@njit(cache=True, nogil=True)
def trace(lines, arc, ys, xs, starts):
    """Follows thin ``lines`` (bool (H, W)) from end to end, or from junction to junction; then closed ones.

    Fills ``arc`` int32 (H, W): number of the arc from 1, 0 elsewhere; ``ys``, ``xs`` the pixels in order and
    ``starts`` where each arc begins in them, one more at the end. Returns how many arcs.
    """
    rows, columns = lines.shape
    count, at = 0, 0
    for round_ in range(3):  # from ends, beside junctions, and what is left: closed lines
        for y0 in range(rows):
            for x0 in range(columns):
                if not lines[y0, x0] or arc[y0, x0] > 0:
                    continue
                _, runs = _neighbours(lines, y0, x0)
                if (round_ == 0 and runs != 1) or (round_ == 1 and runs < 3):
                    continue
                count += 1
                starts[count - 1] = at
                y, x = y0, x0
                while True:
                    arc[y, x] = count
                    ys[at], xs[at] = y, x
                    at += 1
                    ny, nx, best = -1, -1, 99
                    for v in range(max(y - 1, 0), min(y + 2, rows)):
                        for u in range(max(x - 1, 0), min(x + 2, columns)):
                            if lines[v, u] and arc[v, u] == 0:
                                cost = abs(v - y) + abs(u - x)
                                if cost < best:
                                    ny, nx, best = v, u, cost
                    if ny < 0:
                        break
                    y, x = ny, nx
    starts[count] = at
    return count


@njit(cache=True, nogil=True)
def extend(lines, ends, ways, number, arc, support, reach, longest, added):
    """Continues ends of lines as long as enough segmentations have a boundary near.

    Parameters: ``lines`` bool (H, W); ``ends`` int64 (N, 2) row and column, ``ways`` float64 (N, 2) unit
    vectors outwards, ``number`` int64 (N) the arcs they end; ``arc`` int32 (S, H, W): by segmentation the arc a
    pixel belongs to, -1 for one of no arc of ``lines``, 0 none; a pixel of the very arc that ends does not
    count; ``support`` how many segmentations it takes. An extension goes at most ``longest`` pixels, bends by
    at most 40° and stops where support ends or it meets a line; it is set in ``added``.
    """
    rows, columns = lines.shape
    kinds = arc.shape[0]
    for i in range(ends.shape[0]):
        y, x = float(ends[i, 0]), float(ends[i, 1])
        py, px = ends[i, 0], ends[i, 1]
        for _ in range(longest):
            best, by, bx = 0, -1, -1
            for turn in range(3):
                angle = 0.0 if turn == 0 else (0.7 if turn == 1 else -0.7)
                dy = ways[i, 0] * np.cos(angle) - ways[i, 1] * np.sin(angle)
                dx = ways[i, 0] * np.sin(angle) + ways[i, 1] * np.cos(angle)
                v, u = int(np.rint(y + 1.2 * dy)), int(np.rint(x + 1.2 * dx))
                if v < 0 or v >= rows or u < 0 or u >= columns or (v == py and u == px):
                    continue
                votes = 0
                for kind in range(kinds):
                    found = False
                    for q in range(max(v - reach, 0), min(v + reach + 1, rows)):
                        for p in range(max(u - reach, 0), min(u + reach + 1, columns)):
                            other = arc[kind, q, p]
                            if other != 0 and other != number[i]:
                                found = True
                    votes += found
                if votes > best:
                    best, by, bx = votes, v, u
            if best < support:
                break
            if lines[by, bx]:
                break
            added[by, bx] = True
            y, x, py, px = float(by), float(bx), by, bx


@njit(cache=True, nogil=True)
def corners(ys, xs, starts, arm, sharp, strength):
    """float64 (P) into ``strength``: the turn, radians, at pixels of arcs where it is ``sharp`` and largest.

    The turn is between the chords over ``arm`` pixels on either side; within ``arm`` only the largest stays.
    """
    turn = np.zeros(ys.size)
    for a in range(starts.size - 1):
        for i in range(starts[a] + arm, starts[a + 1] - arm):
            by, bx = ys[i] - ys[i - arm], xs[i] - xs[i - arm]
            fy, fx = ys[i + arm] - ys[i], xs[i + arm] - xs[i]
            turn[i] = abs(np.arctan2(by * fx - bx * fy, by * fy + bx * fx))
        for i in range(starts[a] + arm, starts[a + 1] - arm):
            largest = turn[i] >= sharp
            for j in range(max(i - arm, starts[a]), min(i + arm + 1, starts[a + 1])):
                if turn[j] > turn[i] or (turn[j] == turn[i] and j < i):
                    largest = False
            if largest:
                strength[i] = turn[i]


@njit(cache=True, nogil=True)
def diffuse(before, walls, rate, after):
    """One step from ``before`` to ``after`` (float32 (H, W), NaN unknown) between ``walls`` (bool)."""
    rows, columns = before.shape
    for y in range(rows):
        for x in range(columns):
            here = before[y, x]
            after[y, x] = here
            if walls[y, x]:
                continue
            total, count = np.float32(0), 0
            for axis in range(2):
                pair, both = np.float32(0), 0
                for side in (-1, 1):
                    v, u = (y + side, x) if axis == 0 else (y, x + side)
                    if 0 <= v < rows and 0 <= u < columns and not walls[v, u] and not np.isnan(before[v, u]):
                        pair += before[v, u]
                        both += 1
                if both == 2 or (both == 1 and np.isnan(here)):
                    total += pair
                    count += both
            if count > 0:
                mean = total / np.float32(count)
                after[y, x] = mean if np.isnan(here) else here + rate * (mean - here)
