"""What a ray sees: albedo, shading and shadow where it meets a surface; images made of many rays.

Two kernels: :func:`paint` (supersampled brightness) and :func:`probe` (exact truth along single rays).
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, attr-defined"
# ruff: noqa: PLR0917 - numba types what it compiles, wants plain numbers, and NaN is not itself

from __future__ import annotations

import math

import numpy as np
from numba import njit

from visint_lab.rays._kernels import (
    BOX,
    FAR,
    HEIGHTS,
    MESH,
    QUADRIC,
    TORUS,
    nearest,
    revision,
    spline,
)

PLAIN, CHECKER, NOISE, PICTURE, SPLIT = 0, 1, 2, 3, 4
# Columns of probe's result
DEPTH, NX, NY, NZ, THING, FACE, MARK, LIT, ALBEDO, BRIGHTNESS, SEEN = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10
COLUMNS = 11


@njit(error_model="numpy")
def _grid_noise(ix, iy, iz, seed):
    """A hash of a grid point, in [0, 1)."""
    h = (ix * 374761393 + iy * 668265263 + iz * 1440662683 + seed * 1274126177) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 2246822519) & 0xFFFFFFFF
    h = ((h ^ (h >> 16)) * 1103515245) & 0xFFFFFFFF
    return (h ^ (h >> 15)) * 2.3283064365386963e-10


@njit(error_model="numpy")
def _noise(x, y, z, seed, octaves):
    """Value noise summed over octaves, each half as large and half as strong-per-root: in about [0, 1]."""
    total = weight = 0.0
    strength = 1.0
    for octave in range(octaves):
        fx, fy, fz = math.floor(x), math.floor(y), math.floor(z)
        ix, iy, iz = int(fx), int(fy), int(fz)
        u, v, w = x - fx, y - fy, z - fz
        u = u * u * (3 - 2 * u)
        v = v * v * (3 - 2 * v)
        w = w * w * (3 - 2 * w)
        value = 0.0
        for c in range(2):
            for b in range(2):
                left = _grid_noise(ix, iy + b, iz + c, seed + octave)
                line = left + u * (_grid_noise(ix + 1, iy + b, iz + c, seed + octave) - left)
                value += line * (v if b else 1 - v) * (w if c else 1 - w)
        total += strength * (value - 0.5)
        weight += strength * strength
        strength *= 0.75
        x, y, z = 2.03 * x + 7.1, 2.03 * y + 3.3, 2.03 * z + 5.7
    value = 0.5 + 0.95 * total / math.sqrt(weight)
    return min(max(value, 0.0), 1.0)


@njit(error_model="numpy")
def _picture(scene, index, x, y):
    """A texture image at (x, y) in its pixels: bilinear, mirrored beyond its sides."""
    start, rows, columns = scene.pictures[index, 0], scene.pictures[index, 1], scene.pictures[index, 2]
    x = x % (2.0 * columns - 2.0)
    y = y % (2.0 * rows - 2.0)
    x = min(x, 2.0 * columns - 2.0 - x)
    y = min(y, 2.0 * rows - 2.0 - y)
    ix, iy = min(int(x), columns - 2), min(int(y), rows - 2)
    u, v = x - ix, y - iy
    at = start + iy * columns + ix
    top = scene.texels[at] * (1 - u) + scene.texels[at + 1] * u
    low = scene.texels[at + columns] * (1 - u) + scene.texels[at + columns + 1] * u
    return top * (1 - v) + low * v


@njit(error_model="numpy")
def _albedo(scene, row, x, y, z, u, v):
    """(albedo, mark, row of the leaf): ``mark`` changes where the albedo jumps."""
    mark = 0
    while scene.finishes[row, 0] == SPLIT:
        m = scene.materials[row]
        beyond = m[3] * x + m[4] * y + m[5] * z > m[6]
        mark = 2 * mark + (4 if beyond else 2)
        row = scene.finishes[row, 2] if beyond else scene.finishes[row, 1]
    kind = scene.finishes[row, 0]
    m = scene.materials[row]
    a, b, scale = m[0], m[1], m[2]
    if kind == PLAIN:
        return a, mark, row
    if scene.finishes[row, 3] == 1:  # on the surface
        x, y, z = u, v, 0.0
    if kind == CHECKER:
        fields = math.floor(x / scale + m[3]) + math.floor(y / scale + m[4]) + math.floor(z / scale + m[5])
        odd = int(fields) & 1
        return (b if odd else a), mark + odd, row
    if kind == NOISE:
        share = _noise(x / scale, y / scale, z / scale, scene.finishes[row, 1], scene.finishes[row, 2])
    else:
        share = _picture(scene, scene.finishes[row, 1], x / scale + m[3], y / scale + m[4])
    return a + (b - a) * share, mark, row


@njit(error_model="numpy")
def _surface(scene, which, face, x, y, z):
    """Outward normal and surface coordinates (u, v), in lengths, at a point of a thing's own frame."""
    thing = scene.things[which]
    kind = scene.kinds[which, 0]
    nx, ny, nz, u, v = 0.0, 0.0, -1.0, x, y
    if kind == QUADRIC:
        if face > 0:
            nz = -1.0 if face == 1 else 1.0
        else:
            nx, ny = 2.0 * thing[14] * x, 2.0 * thing[15] * y
            nz = 2.0 * thing[16] * z + thing[17]
            girth = thing[22]
            if girth > 0.0:
                u = math.atan2(y, x) * girth
                v = math.asin(min(1.0, max(-1.0, z / girth))) * girth if thing[23] > 0.0 else z
    elif kind == BOX:
        nz = 0.0
        sign = 1.0 if face & 1 else -1.0
        if face < 2:
            nx, u, v = sign, y, z
        elif face < 4:
            ny, u, v = sign, x, z
        else:
            nz = sign
    elif kind == TORUS:
        ring = math.sqrt(x * x + y * y)
        share = 1.0 - thing[14] / ring
        nx, ny, nz = x * share, y * share, z
        u, v = math.atan2(y, x) * thing[14], math.atan2(z, ring - thing[14]) * thing[15]
    elif kind == HEIGHTS:
        pitch, columns, rows = thing[17], int(thing[16]), int(thing[15])
        gx, gy = x / pitch + (columns - 1) / 2, y / pitch + (rows - 1) / 2
        kx = min(max(math.floor(gx), 1), columns - 3)
        ky = min(max(math.floor(gy), 1), rows - 3)
        _, zx, zy = spline(scene.heights, int(thing[14]), columns, gx, gy, kx, ky)
        nx, ny, nz = zx / pitch, zy / pitch, -1.0
    else:
        corner = scene.triangles[face]
        e1x, e1y, e1z, e2x, e2y, e2z = corner[3], corner[4], corner[5], corner[6], corner[7], corner[8]
        sx, sy, sz = x - corner[0], y - corner[1], z - corner[2]
        d11 = e1x * e1x + e1y * e1y + e1z * e1z
        d12 = e1x * e2x + e1y * e2y + e1z * e2z
        d22 = e2x * e2x + e2y * e2y + e2z * e2z
        s1, s2 = sx * e1x + sy * e1y + sz * e1z, sx * e2x + sy * e2y + sz * e2z
        det = d11 * d22 - d12 * d12
        p, q = (d22 * s1 - d12 * s2) / det, (d11 * s2 - d12 * s1) / det
        c = scene.corners[face]
        o = 1.0 - p - q
        nx = o * c[0] + p * c[3] + q * c[6]
        ny = o * c[1] + p * c[4] + q * c[7]
        nz = o * c[2] + p * c[5] + q * c[8]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    return nx / length, ny / length, nz / length, u, v


@njit(error_model="numpy", forceinline=True)
def _look(scene, lamp, ox, oy, oz, dx, dy, dz):
    """What one ray sees: (distance, normal facing it, thing, face, mark, lit, albedo, brightness)."""
    t, which, face = nearest(scene, ox, oy, oz, dx, dy, dz, 1e-9, FAR, False)
    if which < 0:
        return FAR, 0.0, 0.0, 0.0, -1, 0, 0, 0, 0.0, lamp[5]
    thing = scene.things[which]
    wx, wy, wz = ox + t * dx, oy + t * dy, oz + t * dz
    x, y, z = wx - thing[9], wy - thing[10], wz - thing[11]
    px = thing[0] * x + thing[1] * y + thing[2] * z
    py = thing[3] * x + thing[4] * y + thing[5] * z
    pz = thing[6] * x + thing[7] * y + thing[8] * z
    a, b, c, u, v = _surface(scene, which, face, px, py, pz)
    nx = thing[0] * a + thing[3] * b + thing[6] * c
    ny = thing[1] * a + thing[4] * b + thing[7] * c
    nz = thing[2] * a + thing[5] * b + thing[8] * c
    facing = nx * dx + ny * dy + nz * dz
    if facing > 0.0:
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    if scene.kinds[which, 0] == MESH:
        face = scene.patches[face]
    albedo, mark, row = _albedo(scene, scene.kinds[which, 1], px, py, pz, u, v)
    lx, ly, lz, reach = lamp[0], lamp[1], lamp[2], FAR
    if lamp[3] > 0.0:
        lx, ly, lz = lx - wx, ly - wy, lz - wz
        reach = math.sqrt(lx * lx + ly * ly + lz * lz)
        lx, ly, lz = lx / reach, ly / reach, lz / reach
    cosine = nx * lx + ny * ly + nz * lz
    lit = 1 if cosine > 0.0 else 0
    if lit == 1 and lamp[6] > 0.0:
        # Smooth normals of a mesh face the light a little beyond where its flat triangles do: look further off.
        start = 0.1 * scene.things[which, 13] if scene.kinds[which, 0] == MESH else 1e-6 * t
        _, blocker, _ = nearest(scene, wx, wy, wz, lx, ly, lz, start, reach, True)
        lit = 0 if blocker >= 0 else 1
    brightness = albedo * lamp[4]
    if lit == 1:
        brightness += albedo * cosine
        gloss = scene.materials[row, 7]
        if gloss > 0.0:
            mirror = -(2.0 * cosine * facing - (lx * dx + ly * dy + lz * dz))
            if mirror > 0.0:
                brightness += gloss * mirror ** scene.materials[row, 8]
    return t, nx, ny, nz, which, face, mark, lit, albedo, brightness


def _cached(rays):
    """The two kernels. A value they close over is part of numba's cache key, so that a change in the file of
    the rays' functions, which the cache does not look at, is no stale kernel.
    """

    @njit(cache=True, nogil=True, error_model="numpy")
    def paint(scene, lamp, eye, aim, samples, image):
        """Fills ``image`` (H, W) with the mean brightness of samples × samples rays a pixel."""
        if rays < 0:
            return
        height, width = image.shape
        offsets = np.empty((samples * samples, 2))
        for k in range(samples * samples):
            offsets[k, 0] = (k % samples + 0.5) / samples - 0.5
            offsets[k, 1] = (k // samples + 0.5) / samples - 0.5
        share = 1.0 / (samples * samples)
        for row in range(height):
            for column in range(width):
                total = 0.0
                for k in range(samples * samples):
                    u = column + offsets[k, 0]
                    v = row + offsets[k, 1]
                    dx = aim[0, 0] * u + aim[0, 1] * v + aim[0, 2]
                    dy = aim[1, 0] * u + aim[1, 1] * v + aim[1, 2]
                    dz = aim[2, 0] * u + aim[2, 1] * v + aim[2, 2]
                    s = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
                    seen = _look(scene, lamp, eye[0], eye[1], eye[2], dx * s, dy * s, dz * s)
                    total += seen[9]
                image[row, column] = total * share

    @njit(cache=True, nogil=True, error_model="numpy")
    def probe(scene, lamp, eye, aim, other, spots, out):
        """Fills ``out`` (N, COLUMNS) for rays through image points ``spots`` (N, 2), without supersampling.

        SEEN says whether the straight line from the surface point to ``other`` (another eye) is free.
        """
        if rays < 0:
            return
        for i in range(spots.shape[0]):
            u, v = spots[i, 0], spots[i, 1]
            dx = aim[0, 0] * u + aim[0, 1] * v + aim[0, 2]
            dy = aim[1, 0] * u + aim[1, 1] * v + aim[1, 2]
            dz = aim[2, 0] * u + aim[2, 1] * v + aim[2, 2]
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            dx, dy, dz = dx / length, dy / length, dz / length
            seen = _look(scene, lamp, eye[0], eye[1], eye[2], dx, dy, dz)
            t = seen[0]
            row = out[i]
            row[NX], row[NY], row[NZ] = seen[1], seen[2], seen[3]
            row[THING], row[FACE], row[MARK], row[LIT] = seen[4], seen[5], seen[6], seen[7]
            row[ALBEDO], row[BRIGHTNESS] = seen[8], seen[9]
            if seen[4] < 0:
                row[DEPTH], row[SEEN] = np.nan, 0.0
                continue
            row[DEPTH] = t / length
            wx, wy, wz = eye[0] + t * dx, eye[1] + t * dy, eye[2] + t * dz
            tx, ty, tz = other[0] - wx, other[1] - wy, other[2] - wz
            reach = math.sqrt(tx * tx + ty * ty + tz * tz)
            _, blocker, _ = nearest(
                scene, wx, wy, wz, tx / reach, ty / reach, tz / reach, 1e-6 * t, reach, True
            )
            row[SEEN] = 0.0 if blocker >= 0 else 1.0

    return paint, probe


paint, probe = _cached(revision())
