# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Kernels of the joint estimate: the energy's matrix as a 5x5 stencil a pixel, and its multigrid.

A matrix is float32 (H, W, 25): entry (y, x, 5 (j + 2) + i + 2) couples pixel (y, x) with (y + j, x + i). Pixels
outside the domain have an empty row. The energy couples nothing further, and Galerkin coarsening by two with
bilinear interpolation keeps to it: every level has the same form.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def _outer(matrix, ys, xs, cs, n, weight):
    for a in range(n):
        for b in range(n):
            k = 5 * (ys[b] - ys[a] + 2) + xs[b] - xs[a] + 2
            matrix[ys[a], xs[a], k] += weight * cs[a] * cs[b]


@njit(cache=True, nogil=True)
def _slope(y, x, across, down, ys, xs, cs, a, b):
    """The row of a·d_u + b·d_v at (y, x), central where both neighbours belong to it; its length."""
    n = 1
    ys[0], xs[0], cs[0] = y, x, 0.0
    for way in range(2):
        factor = a if way == 0 else b
        if way == 0:
            after = across[y, x]
            before = x > 0 and across[y, x - 1]
        else:
            after = down[y, x]
            before = y > 0 and down[y - 1, x]
        if not after and not before:
            continue
        scale = factor * (0.5 if after and before else 1.0)
        if after:
            ys[n], xs[n], cs[n] = y + way, x + 1 - way, scale
            cs[0] -= scale
            n += 1
        if before:
            ys[n], xs[n], cs[n] = y - way, x - 1 + way, -scale
            cs[0] += scale
            n += 1
    return n


@njit(cache=True, nogil=True)
def assemble(domain, across, down, data, bend_x, bend_y, twist, rows, matrix):
    """The matrix of Σ data d² + bend_x d_uu² + bend_y d_vv² + 2 twist d_uv² + rows₂ (rows₀ d_u + rows₁ d_v)².

    ``across``/``down`` bool (H, W): whether a pixel is joined to its right/lower neighbour.
    """
    height, width = domain.shape
    ys, xs, cs = np.empty(5, np.int64), np.empty(5, np.int64), np.empty(5, np.float64)
    for y in range(height):
        for x in range(width):
            if not domain[y, x]:
                continue
            matrix[y, x, 12] += data[y, x]
            if x > 0 and across[y, x] and across[y, x - 1] and bend_x[y, x] > 0:
                ys[0], ys[1], ys[2] = y, y, y
                xs[0], xs[1], xs[2] = x - 1, x, x + 1
                cs[0], cs[1], cs[2] = 1.0, -2.0, 1.0
                _outer(matrix, ys, xs, cs, 3, bend_x[y, x])
            if y > 0 and down[y, x] and down[y - 1, x] and bend_y[y, x] > 0:
                ys[0], ys[1], ys[2] = y - 1, y, y + 1
                xs[0], xs[1], xs[2] = x, x, x
                cs[0], cs[1], cs[2] = 1.0, -2.0, 1.0
                _outer(matrix, ys, xs, cs, 3, bend_y[y, x])
            if twist[y, x] > 0 and across[y, x] and down[y, x] and down[y, x + 1] and across[y + 1, x]:
                ys[0], ys[1], ys[2], ys[3] = y, y, y + 1, y + 1
                xs[0], xs[1], xs[2], xs[3] = x, x + 1, x, x + 1
                cs[0], cs[1], cs[2], cs[3] = 1.0, -1.0, -1.0, 1.0
                _outer(matrix, ys, xs, cs, 4, 2 * twist[y, x])
            if rows[y, x, 2] > 0:
                n = _slope(y, x, across, down, ys, xs, cs, rows[y, x, 0], rows[y, x, 1])
                _outer(matrix, ys, xs, cs, n, rows[y, x, 2])


@njit(cache=True, nogil=True)
def slopes(domain, across, down, field, out):
    """(H, W, 2): d_u and d_v as :func:`assemble` takes them, 0 where nothing is joined."""
    height, width = domain.shape
    for y in range(height):
        for x in range(width):
            out[y, x, 0] = out[y, x, 1] = 0.0
            if not domain[y, x]:
                continue
            for way in range(2):
                if way == 0:
                    after, before = across[y, x], x > 0 and across[y, x - 1]
                else:
                    after, before = down[y, x], y > 0 and down[y - 1, x]
                total = 0.0
                if after:
                    total += field[y + way, x + 1 - way] - field[y, x]
                if before:
                    total += field[y, x] - field[y - way, x - 1 + way]
                out[y, x, way] = 0.5 * total if after and before else total


@njit(cache=True, nogil=True)
def add_slope_terms(domain, across, down, rows, wanted, out):
    """Adds Σ rows₂ wanted · (row of slopes at the pixel) to ``out``: the right-hand side of the slope terms."""
    height, width = domain.shape
    ys, xs, cs = np.empty(5, np.int64), np.empty(5, np.int64), np.empty(5, np.float64)
    for y in range(height):
        for x in range(width):
            if not domain[y, x] or not rows[y, x, 2] > 0:
                continue
            n = _slope(y, x, across, down, ys, xs, cs, rows[y, x, 0], rows[y, x, 1])
            for a in range(n):
                out[ys[a], xs[a]] += rows[y, x, 2] * cs[a] * wanted[y, x]


@njit(cache=True, nogil=True)
def bends(domain, across, down, field, out):
    """(H, W, 3): d_uu, d_vv and d_uv (of the cell below and right of the pixel), 0 where cut."""
    height, width = domain.shape
    for y in range(height):
        for x in range(width):
            out[y, x, 0] = out[y, x, 1] = out[y, x, 2] = 0.0
            if not domain[y, x]:
                continue
            if x > 0 and across[y, x] and across[y, x - 1]:
                out[y, x, 0] = field[y, x - 1] - 2 * field[y, x] + field[y, x + 1]
            if y > 0 and down[y, x] and down[y - 1, x]:
                out[y, x, 1] = field[y - 1, x] - 2 * field[y, x] + field[y + 1, x]
            if across[y, x] and down[y, x] and down[y, x + 1] and across[y + 1, x]:
                out[y, x, 2] = field[y, x] - field[y, x + 1] - field[y + 1, x] + field[y + 1, x + 1]


@njit(cache=True, nogil=True)
def add_bend_terms(domain, bend_x, bend_y, twist, bent, out):
    """Adds the gradient (half of it) of the plate terms at a field with second differences ``bent``."""
    height, width = domain.shape
    for y in range(height):
        for x in range(width):
            if not domain[y, x]:
                continue
            g = bend_x[y, x] * bent[y, x, 0]
            if g != 0:
                out[y, x - 1] += g
                out[y, x] -= 2 * g
                out[y, x + 1] += g
            g = bend_y[y, x] * bent[y, x, 1]
            if g != 0:
                out[y - 1, x] += g
                out[y, x] -= 2 * g
                out[y + 1, x] += g
            g = 2 * twist[y, x] * bent[y, x, 2]
            if g != 0:
                out[y, x] += g
                out[y, x + 1] -= g
                out[y + 1, x] -= g
                out[y + 1, x + 1] += g


@njit(cache=True, nogil=True)
def packed(matrix, out):
    """The rows of a matrix whose couplings reach two steps at most, (H + 4, W + 4, 13) with a margin."""
    height, width = matrix.shape[:2]
    for y in range(height):
        for x in range(width):
            k = 0
            for j in range(-2, 3):
                reach = 2 - abs(j)
                for i in range(-reach, reach + 1):
                    out[y + 2, x + 2, k] = matrix[y, x, 5 * j + i + 12]
                    k += 1


@njit(cache=True, nogil=True, fastmath=True)
def times_diamond(m, field, out):
    """``out`` = matrix · field, with a margin of two all around; ``m`` as of :func:`packed`."""
    height, width = field.shape
    for y in range(2, height - 2):
        for x in range(2, width - 2):
            r = m[y, x]
            if not r[6] > 0:
                out[y, x] = 0.0
                continue
            out[y, x] = (
                r[0] * field[y - 2, x]
                + r[1] * field[y - 1, x - 1]
                + r[2] * field[y - 1, x]
                + r[3] * field[y - 1, x + 1]
                + r[4] * field[y, x - 2]
                + r[5] * field[y, x - 1]
                + r[6] * field[y, x]
                + r[7] * field[y, x + 1]
                + r[8] * field[y, x + 2]
                + r[9] * field[y + 1, x - 1]
                + r[10] * field[y + 1, x]
                + r[11] * field[y + 1, x + 1]
                + r[12] * field[y + 2, x]
            )


@njit(cache=True, nogil=True, fastmath=True)
def relax_diamond(m, wanted, field, backwards):
    """One Gauss-Seidel sweep in place; arrays as for :func:`times_diamond`."""
    height, width = field.shape
    for line in range(2, height - 2):
        y = height - 1 - line if backwards else line
        for place in range(2, width - 2):
            x = width - 1 - place if backwards else place
            r = m[y, x]
            if not r[6] > 0:
                continue
            others = (
                r[0] * field[y - 2, x]
                + r[1] * field[y - 1, x - 1]
                + r[2] * field[y - 1, x]
                + r[3] * field[y - 1, x + 1]
                + r[4] * field[y, x - 2]
                + r[5] * field[y, x - 1]
                + r[7] * field[y, x + 1]
                + r[8] * field[y, x + 2]
                + r[9] * field[y + 1, x - 1]
                + r[10] * field[y + 1, x]
                + r[11] * field[y + 1, x + 1]
                + r[12] * field[y + 2, x]
            )
            field[y, x] = (wanted[y, x] - others) / r[6]


@njit(cache=True, nogil=True, fastmath=True)
def times(m, field, out):
    """``out`` = matrix · field, float64 (H, W) with a margin of two; ``m`` (H, W, 25) with the same margin."""
    height, width = field.shape
    for y in range(2, height - 2):
        for x in range(2, width - 2):
            total = 0.0
            if m[y, x, 12] > 0:
                for j in range(5):
                    for i in range(5):
                        total += m[y, x, 5 * j + i] * field[y + j - 2, x + i - 2]
            out[y, x] = total


@njit(cache=True, nogil=True, fastmath=True)
def relax(m, wanted, field, backwards):
    """One Gauss-Seidel sweep in place, in or against the order of reading; arrays as for :func:`times`."""
    height, width = field.shape
    for line in range(2, height - 2):
        y = height - 1 - line if backwards else line
        for place in range(2, width - 2):
            x = width - 1 - place if backwards else place
            if not m[y, x, 12] > 0:
                continue
            total = 0.0
            for j in range(5):
                for i in range(5):
                    total += m[y, x, 5 * j + i] * field[y + j - 2, x + i - 2]
            field[y, x] += (wanted[y, x] - total) / m[y, x, 12]


@njit(cache=True, nogil=True)
def coarse_pieces(pieces, out):
    """The label most children of a coarse cell have, 0 (outside) only if none has another."""
    height, width = pieces.shape
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            best, most = 0, 0
            for a in range(4):
                v, u = 2 * y + a // 2, 2 * x + a % 2
                if v >= height or u >= width or pieces[v, u] == 0:
                    continue
                count = 0
                for b in range(4):
                    w, z = 2 * y + b // 2, 2 * x + b % 2
                    if w < height and z < width and pieces[w, z] == pieces[v, u]:
                        count += 1
                if count > most:
                    best, most = pieces[v, u], count
            out[y, x] = best


@njit(cache=True, nogil=True)
def interpolation(pieces, coarse, out):
    """(H, W, 4): weights of a pixel's four coarse neighbours in the order (y, x), (y, x'), (y', x), (y', x').

    Bilinear between cell centres, among cells of the pixel's own piece; all 0 if there is none.
    """
    height, width = pieces.shape
    for y in range(height):
        for x in range(width):
            total = 0.0
            for a in range(4):
                v = y // 2 + (0 if a < 2 else (2 * (y % 2) - 1))
                u = x // 2 + (0 if a % 2 == 0 else (2 * (x % 2) - 1))
                share = (0.75 if a < 2 else 0.25) * (0.75 if a % 2 == 0 else 0.25)
                inside = v >= 0 and u >= 0 and v < coarse.shape[0] and u < coarse.shape[1]
                if pieces[y, x] == 0 or not inside or coarse[v, u] != pieces[y, x]:
                    share = 0.0
                out[y, x, a] = share
                total += share
            if total > 0:
                for a in range(4):
                    out[y, x, a] /= total


@njit(cache=True, nogil=True)
def galerkin(matrix, weights, out):
    """``out`` = Pᵀ A P."""
    height, width = matrix.shape[:2]
    part = np.empty(25)
    for y in range(height):
        for x in range(width):
            if not matrix[y, x, 12] > 0:
                continue
            for k in range(25):  # row of A P, around the pixel's own coarse cell
                part[k] = 0.0
            for j in range(max(-2, -y), min(3, height - y)):
                for i in range(max(-2, -x), min(3, width - x)):
                    value = matrix[y, x, 5 * j + i + 12]
                    if value == 0:
                        continue
                    ny, nx = y + j, x + i
                    down, over = 2 * (ny % 2) - 1, 2 * (nx % 2) - 1
                    base = 5 * (ny // 2 - y // 2 + 2) + nx // 2 - x // 2 + 2
                    w0, w1 = weights[ny, nx, 0], weights[ny, nx, 1]
                    w2, w3 = weights[ny, nx, 2], weights[ny, nx, 3]
                    if w0 != 0:
                        part[base] += value * w0
                    if w1 != 0:
                        part[base + over] += value * w1
                    if w2 != 0:
                        part[base + 5 * down] += value * w2
                    if w3 != 0:
                        part[base + 5 * down + over] += value * w3
            for a in range(4):
                share = weights[y, x, a]
                if share == 0:
                    continue
                dy = 0 if a < 2 else 2 * (y % 2) - 1
                dx = 0 if a % 2 == 0 else 2 * (x % 2) - 1
                for j in range(-2, 3):
                    for i in range(-2, 3):
                        value = part[5 * j + i + 12]
                        if value != 0:
                            out[y // 2 + dy, x // 2 + dx, 5 * (j - dy) + i - dx + 12] += share * value


@njit(cache=True, nogil=True)
def restricted(field, weights, out):
    """``out`` += Pᵀ field; both with a margin of two."""
    height, width = weights.shape[:2]
    for y in range(height):
        for x in range(width):
            for a in range(4):
                share = weights[y, x, a]
                if share != 0:
                    v = y // 2 + (0 if a < 2 else (2 * (y % 2) - 1))
                    u = x // 2 + (0 if a % 2 == 0 else (2 * (x % 2) - 1))
                    out[v + 2, u + 2] += share * field[y + 2, x + 2]


@njit(cache=True, nogil=True)
def add_prolonged(field, weights, out):
    """``out`` += P field; both with a margin of two."""
    height, width = weights.shape[:2]
    for y in range(height):
        for x in range(width):
            for a in range(4):
                share = weights[y, x, a]
                if share != 0:
                    v = y // 2 + (0 if a < 2 else (2 * (y % 2) - 1))
                    u = x // 2 + (0 if a % 2 == 0 else (2 * (x % 2) - 1))
                    out[y + 2, x + 2] += share * field[v + 2, u + 2]
