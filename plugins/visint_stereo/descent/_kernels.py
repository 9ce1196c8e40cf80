# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Kernels of the matcher by descent: one update of a disparity field, and where its matches lead."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def sweep(here, there, weights, smoothness, reach, sides, across, sign, before, after):
    """One Gauss-Newton update of a field: d = d̄ - Σ w J R(d̄) / (λ + Σ w J²)  (Eq. 3.1, corrected).

    Parameters: ``here`` and ``there`` float32 (H, W, 4), attributes of the view that carries the field and of
    the other; ``sign`` -1 if the field is the left view's (its match lies at x - d), else +1; ``sides`` int32
    (H, W) with ``across`` the weight of a neighbour on another side; ``before`` and ``after`` the field,
    float32 (H, W). No step goes further than ``reach`` px from d̄: beyond, the linear model is not to be
    believed. Matches outside the other image take d̄.
    """
    rows, columns, kinds = here.shape
    last = columns - 1
    half, one, two, three = np.float32(0.5), np.float32(1), np.float32(2), np.float32(3)
    for y in range(rows):
        for x in range(columns):
            total, share = np.float32(0), np.float32(0)
            for side in range(4):
                ny = y + (side == 0) - (side == 1)
                nx = x + (side == 2) - (side == 3)
                if ny < 0 or ny >= rows or nx < 0 or nx >= columns:
                    continue
                weight = one if sides[y, x] == sides[ny, nx] else across
                total += weight * before[ny, nx]
                share += weight
            mean = total / share if share > 0 else before[y, x]
            place = np.float32(x) + sign * mean
            if not (place >= 0 and place <= last):
                after[y, x] = mean
                continue
            i = np.int64(place)
            t = place - np.float32(i)
            i0, i2, i3 = max(i - 1, 0), min(i + 1, last), min(i + 2, last)
            slope, strength = np.float32(0), np.float32(0)
            for kind in range(kinds):
                a, b = there[y, i0, kind], there[y, i, kind]
                c, d = there[y, i2, kind], there[y, i3, kind]
                c1 = half * (c - a)
                c2 = a - np.float32(2.5) * b + two * c - half * d
                c3 = half * (d - a) + np.float32(1.5) * (b - c)
                residual = b + t * (c1 + t * (c2 + t * c3)) - here[y, x, kind]
                change = sign * (c1 + t * (two * c2 + three * t * c3))
                slope += weights[kind] * change * residual
                strength += weights[kind] * change * change
            after[y, x] = mean - min(max(slope / (smoothness + strength), -reach), reach)


@njit(cache=True, nogil=True)
def compare(here, there, weights, sign, field, slope, strength, squared):
    """Residuals at a field: float32 (H, W) each, Σ w J R, Σ w J² and Σ w R²; NaN outside the other image."""
    rows, columns, kinds = here.shape
    last = columns - 1
    half, two, three = np.float32(0.5), np.float32(2), np.float32(3)
    for y in range(rows):
        for x in range(columns):
            place = np.float32(x) + sign * field[y, x]
            if not (place >= 0 and place <= last):
                slope[y, x] = strength[y, x] = squared[y, x] = np.float32(np.nan)
                continue
            i = np.int64(place)
            t = place - np.float32(i)
            i0, i2, i3 = max(i - 1, 0), min(i + 1, last), min(i + 2, last)
            pull, steep, error = np.float32(0), np.float32(0), np.float32(0)
            for kind in range(kinds):
                a, b = there[y, i0, kind], there[y, i, kind]
                c, d = there[y, i2, kind], there[y, i3, kind]
                c1 = half * (c - a)
                c2 = a - np.float32(2.5) * b + two * c - half * d
                c3 = half * (d - a) + np.float32(1.5) * (b - c)
                residual = b + t * (c1 + t * (c2 + t * c3)) - here[y, x, kind]
                change = sign * (c1 + t * (two * c2 + three * t * c3))
                pull += weights[kind] * change * residual
                steep += weights[kind] * change * change
                error += weights[kind] * residual * residual
            slope[y, x], strength[y, x], squared[y, x] = pull, steep, error


@njit(cache=True, nogil=True)
def follow(other, field, sign, found):
    """``other`` (H, W) at x + sign · field, linear along the row; NaN outside. found float32 (H, W)."""
    rows, columns = field.shape
    for y in range(rows):
        for x in range(columns):
            place = np.float32(x) + sign * field[y, x]
            if not (place >= 0 and place <= columns - 1):
                found[y, x] = np.float32(np.nan)
                continue
            i = np.int64(place)
            t = place - np.float32(i)
            found[y, x] = (np.float32(1) - t) * other[y, i] + t * other[y, min(i + 1, columns - 1)]


@njit(cache=True, nogil=True)
def seen_from_the_right(left, right):
    """The left view's disparity carried to the right view, float32 (H, W): the nearest wins.

    Neighbours less than two pixels apart there are joined; holes, which the left view does not see, take the
    smaller of their two ends. NaN where a row has nothing.
    """
    rows, columns = left.shape
    for y in range(rows):
        for x in range(columns):
            right[y, x] = np.float32(-np.inf)
        for x in range(columns):
            for step in range(2):
                value = left[y, x]
                if step == 1:
                    if x + 1 == columns or not abs(left[y, x + 1] - value) < 1:
                        continue
                    value = np.float32(0.5) * (value + left[y, x + 1])
                place = np.float32(x) + np.float32(0.5 * step) - value
                if place > -0.5 and place < columns - 0.5:
                    i = np.int64(np.rint(place))
                    right[y, i] = max(right[y, i], value)
        before = np.float32(np.inf)
        x = 0
        while x < columns:
            if right[y, x] > -np.inf:
                before = right[y, x]
                x += 1
                continue
            end = x
            while end < columns and right[y, end] == -np.inf:
                end += 1
            after = right[y, end] if end < columns else np.float32(np.inf)
            value = min(before, after)
            for hole in range(x, end):
                right[y, hole] = value if value < np.inf else np.float32(np.nan)
            x = end
