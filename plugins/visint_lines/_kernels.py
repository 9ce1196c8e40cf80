"""Loops over the pixels of a label map: cracks walked as chains, planes fitted inside a region, thinning."""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

from __future__ import annotations

import math

import numpy as np
from numba import njit

EAST, NORTH, WEST, SOUTH = 0, 1, 2, 3


@njit(cache=True, nogil=True)
def cracks(labels):
    """uint8 (H + 1, W + 1): bit d of a lattice point is set where a crack leaves it in direction d."""
    height, width = labels.shape
    bits = np.zeros((height + 1, width + 1), np.uint8)
    for r in range(height):
        for c in range(width):
            if r > 0 and labels[r, c] != labels[r - 1, c]:
                bits[r, c] |= 1 << EAST
                bits[r, c + 1] |= 1 << WEST
            if c > 0 and labels[r, c] != labels[r, c - 1]:
                bits[r, c] |= 1 << SOUTH
                bits[r + 1, c] |= 1 << NORTH
    return bits


@njit(cache=True, nogil=True)
def is_node(labels, bits, r, c):
    """Whether chains end at a lattice point: no, where exactly two pairs of cracks pass each other by."""
    b = bits[r, c]
    degree = (b & 1) + ((b >> 1) & 1) + ((b >> 2) & 1) + ((b >> 3) & 1)
    if degree in (0, 2):
        return False
    if degree < 4:
        return True
    return labels[r - 1, c - 1] != labels[r, c] and labels[r - 1, c] != labels[r, c - 1]


@njit(cache=True, nogil=True)
def _onward(labels, bits, r, c, came):
    """The direction in which a chain goes on that came to (r, c) walking in direction ``came``."""
    back = (came + 2) % 4
    b = bits[r, c]
    if b == 15:  # two chains touch: each keeps to the corner of the region that is not connected across
        if labels[r - 1, c - 1] == labels[r, c]:
            return _pair_ne(back)
        return _pair_nw(back)
    for d in range(4):
        if d != back and (b >> d) & 1:
            return d
    return -1


@njit(cache=True, nogil=True)
def _pair_ne(back):
    if back == NORTH:
        return EAST
    if back == EAST:
        return NORTH
    if back == WEST:
        return SOUTH
    return WEST


@njit(cache=True, nogil=True)
def _pair_nw(back):
    if back == NORTH:
        return WEST
    if back == WEST:
        return NORTH
    if back == EAST:
        return SOUTH
    return EAST


@njit(cache=True, nogil=True)
def chains(labels, bits):
    """(points (N, 2) lattice row and column, first (A + 1), closed (A), left (A), right (A)) of all chains.

    Chains between nodes first, then those without one, which end where they start.
    """
    height, width = labels.shape
    total = 0
    for r in range(height + 1):
        for c in range(width + 1):
            for d in range(4):
                total += (bits[r, c] >> d) & 1
    points = np.empty((2 * total + 2, 2), np.int64)
    first = np.zeros(total + 2, np.int64)
    closed = np.zeros(total + 1, np.bool_)
    sides = np.zeros((total + 1, 2), np.int64)
    done = np.zeros((height + 1, width + 1), np.uint8)
    count, at = 0, 0
    for sweep in range(2):
        for r in range(height + 1):
            for c in range(width + 1):
                if bits[r, c] == 0 or (sweep == 0 and not is_node(labels, bits, r, c)):
                    continue
                for d in range(4):
                    if not (bits[r, c] >> d) & 1 or (done[r, c] >> d) & 1:
                        continue
                    y, x, way = r, c, d
                    points[at, 0], points[at, 1] = y, x
                    at += 1
                    if d == EAST:
                        sides[count, 0], sides[count, 1] = labels[r - 1, c], labels[r, c]
                    elif d == NORTH:
                        sides[count, 0], sides[count, 1] = labels[r - 1, c - 1], labels[r - 1, c]
                    elif d == WEST:
                        sides[count, 0], sides[count, 1] = labels[r, c - 1], labels[r - 1, c - 1]
                    else:
                        sides[count, 0], sides[count, 1] = labels[r, c], labels[r, c - 1]
                    while True:
                        done[y, x] |= 1 << way
                        if way == EAST:
                            x += 1
                        elif way == NORTH:
                            y -= 1
                        elif way == WEST:
                            x -= 1
                        else:
                            y += 1
                        done[y, x] |= 1 << ((way + 2) % 4)
                        points[at, 0], points[at, 1] = y, x
                        at += 1
                        if sweep == 0 and is_node(labels, bits, y, x):
                            break
                        way = _onward(labels, bits, y, x, way)
                        if way < 0 or (done[y, x] >> way) & 1:
                            break
                    closed[count] = sweep == 1
                    count += 1
                    first[count] = at
    return points[:at], first[: count + 1], closed[:count], sides[:count]


@njit(cache=True, nogil=True)
def planes_within(nearness, labels, radius):
    """float64 (H, W, 3): (w, ∂w/∂column, ∂w/∂row) of planes fitted to ``nearness`` w = 1/Z.

    Only pixels of the same label in a square of ``radius`` take part; NaN where they do not fix a plane.
    """
    height, width = labels.shape
    out = np.full((height, width, 3), np.nan)
    for r in range(height):
        for c in range(width):
            n = sx = sy = sxx = sxy = syy = sz = sxz = syz = 0.0
            for y in range(max(0, r - radius), min(height, r + radius + 1)):
                for x in range(max(0, c - radius), min(width, c + radius + 1)):
                    z = nearness[y, x]
                    if labels[y, x] != labels[r, c] or math.isnan(z):
                        continue
                    dx, dy = float(x - c), float(y - r)
                    n += 1.0
                    sx += dx
                    sy += dy
                    sxx += dx * dx
                    sxy += dx * dy
                    syy += dy * dy
                    sz += z
                    sxz += dx * z
                    syz += dy * z
            if n < 4.0:
                continue
            mx, my, mz = sx / n, sy / n, sz / n
            cxx, cxy, cyy = sxx - n * mx * mx, sxy - n * mx * my, syy - n * my * my
            cxz, cyz = sxz - n * mx * mz, syz - n * my * mz
            det = cxx * cyy - cxy * cxy
            if det <= 1e-9 * n:
                continue
            p, q = (cyy * cxz - cxy * cyz) / det, (cxx * cyz - cxy * cxz) / det
            out[r, c, 0] = mz - p * mx - q * my
            out[r, c, 1] = p
            out[r, c, 2] = q
    return out


@njit(cache=True, nogil=True)
def components(labels):
    """int32 (H, W): 4-connected components of equal labels, numbered from 0 in raster order."""
    height, width = labels.shape
    parent = np.arange(height * width)
    for r in range(height):
        for c in range(width):
            for y, x in ((r - 1, c), (r, c - 1)):
                if y < 0 or x < 0 or labels[y, x] != labels[r, c]:
                    continue
                a, b = r * width + c, y * width + x
                while parent[a] != a:
                    parent[a] = parent[parent[a]]
                    a = parent[a]
                while parent[b] != b:
                    parent[b] = parent[parent[b]]
                    b = parent[b]
                if a < b:
                    parent[b] = a
                else:
                    parent[a] = b
    out = np.empty((height, width), np.int32)
    number = np.full(height * width, -1, np.int32)
    count = 0
    for i in range(height * width):
        a = i
        while parent[a] != a:
            a = parent[a]
        if number[a] < 0:
            number[a] = count
            count += 1
        out[i // width, i % width] = number[a]
    return out


@njit(cache=True, nogil=True)
def thinned(lines):
    """bool (H, W): a skeleton one pixel wide (Zhang and Suen 1984, DOI 10.1145/357994.358023)."""
    height, width = lines.shape
    image = np.zeros((height + 2, width + 2), np.uint8)
    image[1:-1, 1:-1] = lines
    gone = np.zeros_like(image)
    changed = True
    while changed:
        changed = False
        for step in range(2):
            for r in range(1, height + 1):
                for c in range(1, width + 1):
                    if image[r, c] == 0:
                        continue
                    n = (
                        image[r - 1, c],
                        image[r - 1, c + 1],
                        image[r, c + 1],
                        image[r + 1, c + 1],
                        image[r + 1, c],
                        image[r + 1, c - 1],
                        image[r, c - 1],
                        image[r - 1, c - 1],
                    )
                    around, turns = 0, 0
                    for i in range(8):
                        around += n[i]
                        if n[i] == 0 and n[(i + 1) % 8] == 1:
                            turns += 1
                    if around < 2 or around > 6 or turns != 1:
                        continue
                    if step == 0:
                        if n[0] * n[2] * n[4] or n[2] * n[4] * n[6]:
                            continue
                    elif n[0] * n[2] * n[6] or n[0] * n[4] * n[6]:
                        continue
                    gone[r, c] = 1
                    changed = True
            for r in range(1, height + 1):
                for c in range(1, width + 1):
                    if gone[r, c]:
                        image[r, c] = 0
                        gone[r, c] = 0
    return image[1:-1, 1:-1] > 0


@njit(cache=True, nogil=True)
def _links(lines, r, c, out):
    """Fills ``out`` (8, 2) with the neighbours of a skeleton pixel; diagonal ones only if no corner joins."""
    height, width = lines.shape
    n = 0
    for dr, dc in ((0, 1), (-1, 0), (0, -1), (1, 0), (-1, 1), (-1, -1), (1, -1), (1, 1)):
        y, x = r + dr, c + dc
        if y < 0 or x < 0 or y >= height or x >= width or not lines[y, x]:
            continue
        if dr != 0 and dc != 0 and (lines[r, x] or lines[y, c]):
            continue
        out[n, 0], out[n, 1] = y, x
        n += 1
    return n


@njit(cache=True, nogil=True)
def walks(lines):
    """(points (N, 2) row and column, first (A + 1), closed (A)) of a skeleton's chains between its nodes."""
    height, width = lines.shape
    near, ahead = np.empty((8, 2), np.int64), np.empty((8, 2), np.int64)
    degree = np.zeros((height, width), np.int64)
    total = 0
    for r in range(height):
        for c in range(width):
            if lines[r, c]:
                degree[r, c] = _links(lines, r, c, near)
                total += degree[r, c] + 1
    points = np.empty((2 * total + 2, 2), np.int64)
    first = np.zeros(total + 2, np.int64)
    closed = np.zeros(total + 1, np.bool_)
    done = np.zeros((height, width), np.bool_)
    count, at = 0, 0
    for sweep in range(2):
        for r in range(height):
            for c in range(width):
                if not lines[r, c] or degree[r, c] == 0:
                    continue
                if (sweep == 0) == (degree[r, c] == 2) or (sweep == 1 and done[r, c]):
                    continue
                n = _links(lines, r, c, near)
                for k in range(1 if sweep == 1 else n):
                    y, x = near[k, 0], near[k, 1]
                    if degree[y, x] == 2 and done[y, x]:
                        continue
                    if degree[y, x] != 2 and (y < r or (y == r and x < c)):
                        continue  # two branches side by side: walked from the first of them
                    points[at, 0], points[at, 1] = r, c
                    at += 1
                    before_r, before_c = r, c
                    while degree[y, x] == 2 and not (y == r and x == c):
                        done[y, x] = True
                        points[at, 0], points[at, 1] = y, x
                        at += 1
                        _links(lines, y, x, ahead)
                        i = 1 if ahead[0, 0] == before_r and ahead[0, 1] == before_c else 0
                        before_r, before_c = y, x
                        y, x = ahead[i, 0], ahead[i, 1]
                    points[at, 0], points[at, 1] = y, x
                    at += 1
                    done[r, c] = True
                    closed[count] = sweep == 1
                    count += 1
                    first[count] = at
    return points[:at], first[: count + 1], closed[:count]
