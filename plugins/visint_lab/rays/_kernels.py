"""Where rays meet surfaces. float64 throughout; directions are unit vectors.

A scene arrives as one named tuple of arrays (:class:`visint_lab.render.packing.Packed`). Rays are
turned into each thing's own frame by a rotation and a shift, so that distances along a ray are the same in
every frame.

These functions are compiled as parts of ``render/_kernels.py`` and kept in its cache.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, attr-defined"
# ruff: noqa: PLR0917, PLR0124 - numba types what it compiles, wants plain numbers, and NaN is not itself

from __future__ import annotations

import marshal
import math
import zlib

import numpy as np
from numba import njit

QUADRIC, BOX, TORUS, HEIGHTS, MESH = 0, 1, 2, 3, 4
FAR = 1e30


@njit(error_model="numpy")
def meet_quadric(things, i, ox, oy, oz, dx, dy, dz, near):
    """Solid {a x² + b y² + c z² + d z + e ≤ 0, low ≤ z ≤ high}; without caps only its mantle."""
    a, b, c, d, e = things[i, 14], things[i, 15], things[i, 16], things[i, 17], things[i, 18]
    low, high, caps = things[i, 19], things[i, 20], things[i, 21]
    best, face = FAR, 0
    qa = a * dx * dx + b * dy * dy + c * dz * dz
    qb = a * ox * dx + b * oy * dy + c * oz * dz + 0.5 * d * dz
    qc = a * ox * ox + b * oy * oy + c * oz * oz + d * oz + e
    disc = qb * qb - qa * qc
    if disc >= 0.0:
        root = -qb - math.copysign(math.sqrt(disc), qb)
        for turn in range(2):
            over, under = (qc, root) if turn == 0 else (root, qa)
            t = over / under if under != 0.0 else FAR
            z = oz + t * dz
            if near < t < best and low <= z <= high:
                best = t
    if caps > 0.0 and dz != 0.0:
        for side in range(2):
            t = ((low if side == 0 else high) - oz) / dz
            if near < t < best:
                x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
                if a * x * x + b * y * y + c * z * z + d * z + e <= 0.0:
                    best, face = t, 1 + side
    return best, face


@njit(error_model="numpy")
def meet_box(things, i, ox, oy, oz, dx, dy, dz, near):
    """Faces 0..5: −x, +x, −y, +y, −z, +z of the box of half sides things[i, 14:17]."""
    enter, leave, into, out = -FAR, FAR, 0, 0
    for axis in range(3):
        o = ox if axis == 0 else (oy if axis == 1 else oz)
        d = dx if axis == 0 else (dy if axis == 1 else dz)
        half = things[i, 14 + axis]
        if d == 0.0:
            if abs(o) > half:
                return FAR, 0
            continue
        first, last = (-half - o) / d, (half - o) / d
        one, two = 2 * axis, 2 * axis + 1
        if first > last:
            first, last, one, two = last, first, two, one
        if first > enter:
            enter, into = first, one
        if last < leave:
            leave, out = last, two
    if enter > leave or leave <= near:
        return FAR, 0
    if enter > near:
        return enter, into
    return leave, out


@njit(error_model="numpy")
def first_root(c2, c1, c0, low, high):
    """The first t in [low, high] where t⁴ + c2 t² + c1 t + c0 passes from above to below 0, or FAR."""
    p, q = c2 / 2.0, c1 / 4.0  # t³ + p t + q = 0 where the slope vanishes
    stops = np.empty(4)
    count = 0
    disc = q * q / 4.0 + p * p * p / 27.0
    if disc > 0.0:
        s = math.sqrt(disc)
        x, y = -q / 2.0 + s, -q / 2.0 - s
        stops[0] = math.copysign(abs(x) ** (1.0 / 3.0), x) + math.copysign(abs(y) ** (1.0 / 3.0), y)
        count = 1
    elif p < 0.0:
        r = 2.0 * math.sqrt(-p / 3.0)
        angle = math.acos(min(1.0, max(-1.0, 3.0 * q / (p * r)))) / 3.0
        stops[0] = r * math.cos(angle + 2.0 * math.pi / 3.0)
        stops[1] = r * math.cos(angle - 2.0 * math.pi / 3.0)
        stops[2] = r * math.cos(angle)
        count = 3
    before = low
    above = ((low * low + c2) * low + c1) * low + c0 > 0.0
    for i in range(count + 1):
        after = high if i == count else stops[i]
        if after <= before or after > high:
            if i < count:
                continue
            after = high
        over = ((after * after + c2) * after + c1) * after + c0 > 0.0
        if above and not over:
            a, b = before, after
            t = 0.5 * (a + b)
            for _ in range(60):
                value = ((t * t + c2) * t + c1) * t + c0
                if value > 0.0:
                    a = t
                else:
                    b = t
                slope = (4.0 * t * t + 2.0 * c2) * t + c1
                step = t - value / slope if slope != 0.0 else a
                if not a < step < b:
                    step = 0.5 * (a + b)
                if abs(step - t) < 1e-13 * high:
                    return step
                t = step
            return t
        before, above = after, over
    return FAR


@njit(error_model="numpy")
def meet_torus(things, i, ox, oy, oz, dx, dy, dz, near):
    """Torus about z: (|p|² + R² − r²)² = 4R²(x² + y²), as a quartic about the point nearest its centre."""
    big, small = things[i, 14], things[i, 15]
    mid = -(ox * dx + oy * dy + oz * dz)
    px, py, pz = ox + mid * dx, oy + mid * dy, oz + mid * dz
    m = px * px + py * py + pz * pz
    reach = (big + small) ** 2 - m
    if reach <= 0.0:
        return FAR, 0
    high = math.sqrt(reach) * 1.0000001
    low = max(-high, near - mid)
    g = m + big * big - small * small
    c2 = 2.0 * g - 4.0 * big * big * (dx * dx + dy * dy)
    c1 = -8.0 * big * big * (px * dx + py * dy)
    c0 = g * g - 4.0 * big * big * (px * px + py * py)
    t = first_root(c2, c1, c0, low, high)
    return (t + mid if t < FAR else FAR), 0


@njit(error_model="numpy")
def spline(heights, start, columns, gx, gy, kx, ky):
    """Cubic B-spline surface and its slopes (per cell) in cell (kx, ky) at grid position (gx, gy)."""
    s, t = gx - kx, gy - ky
    wx = ((1 - s) ** 3 / 6, (3 * s**3 - 6 * s * s + 4) / 6, (-3 * s**3 + 3 * s * s + 3 * s + 1) / 6, s**3 / 6)
    vx = (-((1 - s) ** 2) / 2, (3 * s * s - 4 * s) / 2, (-3 * s * s + 2 * s + 1) / 2, s * s / 2)
    wy = ((1 - t) ** 3 / 6, (3 * t**3 - 6 * t * t + 4) / 6, (-3 * t**3 + 3 * t * t + 3 * t + 1) / 6, t**3 / 6)
    vy = (-((1 - t) ** 2) / 2, (3 * t * t - 4 * t) / 2, (-3 * t * t + 2 * t + 1) / 2, t * t / 2)
    z = zx = zy = 0.0
    for j in range(4):
        row = start + (ky - 1 + j) * columns + kx - 1
        line = slope = 0.0
        for i in range(4):
            line += wx[i] * heights[row + i]
            slope += vx[i] * heights[row + i]
        z += wy[j] * line
        zx += wy[j] * slope
        zy += vy[j] * line
    return z, zx, zy


@njit(error_model="numpy")
def meet_heights(things, i, heights, ox, oy, oz, dx, dy, dz, near):
    """Surface z = S(x, y) over a grid: walk from cell to cell, look for a change of side in each."""
    start, rows, columns, pitch = int(things[i, 14]), int(things[i, 15]), int(things[i, 16]), things[i, 17]
    gx, gy, ex, ey = ox / pitch + (columns - 1) / 2, oy / pitch + (rows - 1) / 2, dx / pitch, dy / pitch
    enter, leave = near, FAR
    for axis in range(3):
        o = gx if axis == 0 else (gy if axis == 1 else oz)
        d = ex if axis == 0 else (ey if axis == 1 else dz)
        low = things[i, 18] if axis == 2 else 1.0
        high = things[i, 19] if axis == 2 else (columns - 2.0 if axis == 0 else rows - 2.0)
        if d == 0.0:
            if o < low or o > high:
                return FAR, 0
            continue
        first, last = (low - o) / d, (high - o) / d
        if first > last:
            first, last = last, first
        enter, leave = max(enter, first), min(leave, last)
    if enter >= leave:
        return FAR, 0
    t, side, known = enter, 0.0, False
    while t < leave:
        ahead = min(t + 1e-9 * (1.0 + abs(t)), leave)
        kx = min(max(math.floor(gx + ahead * ex), 1), columns - 3)
        ky = min(max(math.floor(gy + ahead * ey), 1), rows - 3)
        stop = leave
        if ex != 0.0:
            stop = min(stop, ((kx + 1 if ex > 0.0 else kx) - gx) / ex)
        if ey != 0.0:
            stop = min(stop, ((ky + 1 if ey > 0.0 else ky) - gy) / ey)
        stop = max(stop, ahead)
        if not known:
            z, _, _ = spline(heights, start, columns, gx + t * ex, gy + t * ey, kx, ky)
            side = oz + t * dz - z
        z, _, _ = spline(heights, start, columns, gx + stop * ex, gy + stop * ey, kx, ky)
        after = oz + stop * dz - z
        if side * after <= 0.0:  # never so where a height is unknown
            a, b, m = t, stop, t + (stop - t) * (side / (side - after) if side != after else 0.5)
            for _ in range(50):
                z, zx, zy = spline(heights, start, columns, gx + m * ex, gy + m * ey, kx, ky)
                value = oz + m * dz - z
                if value * side > 0.0:
                    a = m
                else:
                    b = m
                slope = dz - zx * ex - zy * ey
                step = m - value / slope if slope != 0.0 else a
                if not a <= step <= b:
                    step = 0.5 * (a + b)
                if abs(step - m) < 1e-12 * (1.0 + abs(m)):
                    break
                m = step
            return m, 0
        known = after == after
        side, t = after, stop
    return FAR, 0


@njit(error_model="numpy")
def entry_box(bounds, node, ox, oy, oz, ix, iy, iz, near, far):
    """Where a ray of inverse direction (ix, iy, iz) enters a node's box, FAR if not between near and far."""
    x0, x1 = (bounds[node, 0] - ox) * ix, (bounds[node, 3] - ox) * ix
    y0, y1 = (bounds[node, 1] - oy) * iy, (bounds[node, 4] - oy) * iy
    z0, z1 = (bounds[node, 2] - oz) * iz, (bounds[node, 5] - oz) * iz
    enter = max(min(x0, x1), min(y0, y1), min(z0, z1))
    leave = min(max(x0, x1), max(y0, y1), max(z0, z1))
    return FAR if enter > leave or leave < near or enter > far else enter


@njit(error_model="numpy")
def in_leaf(triangles, first, last, ox, oy, oz, dx, dy, dz, near, best):
    """Nearest of a few triangles (Möller and Trumbore 1997, doi:10.1080/10867651.1997.10487468)."""
    face = -1
    for k in range(first, last):
        e1x, e1y, e1z = triangles[k, 3], triangles[k, 4], triangles[k, 5]
        e2x, e2y, e2z = triangles[k, 6], triangles[k, 7], triangles[k, 8]
        hx, hy, hz = dy * e2z - dz * e2y, dz * e2x - dx * e2z, dx * e2y - dy * e2x
        det = e1x * hx + e1y * hy + e1z * hz
        if det == 0.0:
            continue
        scale = 1.0 / det
        sx, sy, sz = ox - triangles[k, 0], oy - triangles[k, 1], oz - triangles[k, 2]
        u = (sx * hx + sy * hy + sz * hz) * scale
        if u < 0.0 or u > 1.0:
            continue
        qx, qy, qz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
        w = (dx * qx + dy * qy + dz * qz) * scale
        t = (e2x * qx + e2y * qy + e2z * qz) * scale
        if w >= 0.0 and u + w <= 1.0 and near < t < best:
            best, face = t, k
    return best, face


@njit(error_model="numpy")
def meet_mesh(root, bounds, links, triangles, ox, oy, oz, dx, dy, dz, near, far, anything):
    """Nearest triangle in a tree of boxes, nearer boxes first; the face is the triangle's index."""
    best, face = far, -1
    ix = 1.0 / dx if dx != 0.0 else FAR
    iy = 1.0 / dy if dy != 0.0 else FAR
    iz = 1.0 / dz if dz != 0.0 else FAR
    if entry_box(bounds, root, ox, oy, oz, ix, iy, iz, near, far) == FAR:
        return FAR, 0
    stack = np.empty(64, np.int64)
    top, node = 0, root
    while True:
        first, second = links[node, 0], links[node, 1]
        if second > 0:
            here = entry_box(bounds, first, ox, oy, oz, ix, iy, iz, near, best)
            there = entry_box(bounds, second, ox, oy, oz, ix, iy, iz, near, best)
            if there < here:
                first, second, here, there = second, first, there, here
            if there < FAR:
                stack[top] = second
                top += 1
            if here < FAR:
                node = first
                continue
        else:
            best, found = in_leaf(triangles, first, first - second, ox, oy, oz, dx, dy, dz, near, best)
            if found >= 0:
                face = found
                if anything:
                    break
        while top > 0:  # boxes behind what was found meanwhile need no look
            top -= 1
            node = stack[top]
            if entry_box(bounds, node, ox, oy, oz, ix, iy, iz, near, best) < FAR:
                break
        else:
            break
    return (best if face >= 0 else FAR), face


@njit(error_model="numpy", forceinline=True)
def nearest(scene, ox, oy, oz, dx, dy, dz, near, far, anything):
    """(distance, thing, face) of the nearest surface between near and far; of any if ``anything``."""
    things = scene.things
    best, which, where = far, -1, 0
    for i in range(things.shape[0]):
        x, y, z = ox - things[i, 9], oy - things[i, 10], oz - things[i, 11]
        radius = things[i, 13]
        if radius > 0.0:
            along = x * dx + y * dy + z * dz
            if x * x + y * y + z * z - along * along > radius * radius:
                continue
        px = things[i, 0] * x + things[i, 1] * y + things[i, 2] * z
        py = things[i, 3] * x + things[i, 4] * y + things[i, 5] * z
        pz = things[i, 6] * x + things[i, 7] * y + things[i, 8] * z
        qx = things[i, 0] * dx + things[i, 1] * dy + things[i, 2] * dz
        qy = things[i, 3] * dx + things[i, 4] * dy + things[i, 5] * dz
        qz = things[i, 6] * dx + things[i, 7] * dy + things[i, 8] * dz
        kind = scene.kinds[i, 0]
        if kind == QUADRIC:
            t, face = meet_quadric(things, i, px, py, pz, qx, qy, qz, near)
        elif kind == BOX:
            t, face = meet_box(things, i, px, py, pz, qx, qy, qz, near)
        elif kind == TORUS:
            t, face = meet_torus(things, i, px, py, pz, qx, qy, qz, near)
        elif kind == HEIGHTS:
            t, face = meet_heights(things, i, scene.heights, px, py, pz, qx, qy, qz, near)
        else:
            t, face = meet_mesh(
                int(things[i, 14]),
                scene.bounds,
                scene.links,
                scene.triangles,
                px,
                py,
                pz,
                qx,
                qy,
                qz,
                near,
                best,
                anything,
            )
        if t < best:
            best, which, where = t, i, face
            if anything:
                break
    return best, which, where


def revision() -> int:
    """A number that changes with this file's code: numba's cache looks at the caller's file alone."""
    parts = [entry_box, meet_quadric, meet_box, first_root, meet_torus, spline, meet_heights, in_leaf]
    parts += [meet_mesh, nearest]
    return zlib.crc32(b"".join(marshal.dumps(part.py_func.__code__) for part in parts))
