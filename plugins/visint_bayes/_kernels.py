# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Kernels of consistency mapping."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def _target(lines, weight, reach, y, x):
    """(row, column, mean weight): the weighted mean of the sites around (y, x), rounded to the pixel."""
    rows, columns = lines.shape
    total, down, across, squares = 0.0, 0.0, 0.0, 0.0
    for v in range(max(y - reach, 0), min(y + reach + 1, rows)):
        for u in range(max(x - reach, 0), min(x + reach + 1, columns)):
            if lines[v, u]:
                w = weight[v, u]
                total += w
                down += w * v
                across += w * u
                squares += w * w
    return int(np.floor(down / total + 0.5)), int(np.floor(across / total + 0.5)), min(squares / total, 1.0)


@njit(cache=True, nogil=True)
def draw_together(lines, weight, reach, moved, sure):
    """Sets ``moved`` (bool (H, W)) where sites of ``lines`` go by Eq. 5.25, and ``sure`` to their mean weight.

    Neighbouring sites stay connected: the pixels between their targets are set too.
    """
    rows, columns = lines.shape
    for y in range(rows):
        for x in range(columns):
            if not lines[y, x]:
                continue
            ty, tx, trust = _target(lines, weight, reach, y, x)
            moved[ty, tx] = True
            sure[ty, tx] = max(sure[ty, tx], np.float32(trust))
            for way in range(4):
                v, u = y + (way > 0), x + (1 if way == 0 else way - 2)
                if v >= rows or u < 0 or u >= columns or not lines[v, u]:
                    continue
                sy, sx, other = _target(lines, weight, reach, v, u)
                far = max(abs(sy - ty), abs(sx - tx))
                for step in range(1, far):
                    py = int(np.floor(ty + (sy - ty) * step / far + 0.5))
                    px = int(np.floor(tx + (sx - tx) * step / far + 0.5))
                    moved[py, px] = True
                    sure[py, px] = max(sure[py, px], np.float32(min(trust, other)))


@njit(cache=True, nogil=True)
def step(value, sigma, trust, before, sure, reached, strengths, after, confidence):
    """One Jacobi step of Eq. 5.48 in disparity, and the Kalman filter of its confidence; float32 (H, W) each.

    What the neighbours predict is as sure as they are on the average, less 1/λ_s.
    ``strengths``: smoothness λ_s (px⁻²), the least sigma (px), and what a px² of the level is in full size.
    """
    rows, columns = before.shape
    smoothness, sharpest, square = strengths[0], strengths[1], strengths[2]
    one = np.float32(1)
    for y in range(rows):
        for x in range(columns):
            bits = reached[y, x]
            total, around, n = np.float32(0), np.float32(0), np.float32(0)
            for k in range(4):
                if bits >> k & 1:
                    v, u = y + (k == 2) - (k == 0), x + (k == 1) - (k == 3)
                    near = before[v, u]
                    if not np.isnan(near):
                        total += near
                        n += one
                        around += sure[v, u]
            beta = np.float32(0)
            if trust[y, x] > 0:
                spread = max(sigma[y, x], sharpest)
                beta = trust[y, x] / (spread * spread)
            pull = smoothness * np.float32(0.25) * n
            if beta + pull > 0:
                told = beta * value[y, x] if beta > 0 else np.float32(0)
                after[y, x] = (told + smoothness * np.float32(0.25) * total) / (beta + pull)
            else:
                after[y, x] = before[y, x]
            c = around / n if n > 0 else sure[y, x]
            predicted = one / c - one if c > 0 else np.float32(np.inf)
            if n > 0:
                predicted += square / smoothness
            precision = one / max(predicted, np.float32(1e-6)) + beta / square
            confidence[y, x] = precision / (precision + one)


@njit(cache=True, nogil=True)
def bend_down(depth, told, trust, sure, reached, alpha, pixels, after, confidence):
    """One step of Eq. 5.80 where the bend ``told`` and the map's own differ in sign, as far as ``trust`` goes.

    ``pixels`` is fB times the full size of a pixel of the level: what the step moved, px², counts as doubt.
    Returns how many moved.
    """
    rows, columns = depth.shape
    half, one, moved = np.float32(0.5), np.float32(1), 0
    for y in range(rows):
        for x in range(columns):
            here = depth[y, x]
            after[y, x], confidence[y, x] = here, sure[y, x]
            if not trust[y, x] > 0 or np.isnan(here):
                continue
            bits = reached[y, x]
            bend, axes = np.float32(0), 0
            if bits & 1 and bits & 4:
                pair = half * (depth[y - 1, x] + depth[y + 1, x]) - here
                if not np.isnan(pair):
                    bend += pair
                    axes += 1
            if bits & 2 and bits & 8:
                pair = half * (depth[y, x - 1] + depth[y, x + 1]) - here
                if not np.isnan(pair):
                    bend += pair
                    axes += 1
            if axes == 0:
                continue
            bend /= np.float32(axes)
            if not bend * told[y, x] < 0:
                continue
            change = trust[y, x] * (bend - alpha * told[y, x])
            after[y, x] = here + change
            moved += 1
            around, n = np.float32(0), 0
            for k in range(4):
                if bits >> k & 1:
                    around += sure[y + (k == 2) - (k == 0), x + (k == 1) - (k == 3)]
                    n += 1
            mixed = around / np.float32(n)
            off = pixels * change / (here * here)
            confidence[y, x] = mixed / (one + mixed * off * off) if mixed > 0 else np.float32(0)
    return moved


@njit(cache=True, nogil=True)
def slopes_of(normals, depth, focal, cx, cy, slopes):
    """Slopes per pixel (H, W, 2) of a surface at ``depth`` with these ``normals``; NaN if seen from behind."""
    rows, columns = depth.shape
    for y in range(rows):
        for x in range(columns):
            a, b, c = normals[y, x, 0], normals[y, x, 1], normals[y, x, 2]
            facing = (a * (np.float32(x) - cx) + b * (np.float32(y) - cy)) / focal + c
            scale = -depth[y, x] / (focal * facing) if facing < 0 else np.float32(np.nan)
            slopes[y, x, 0], slopes[y, x, 1] = a * scale, b * scale


@njit(cache=True, nogil=True)
def _applied(field, beta, reached, weight, out):
    """out = (β + Σ w) field - Σ w field of the linked neighbours: the normal equations of Eq. 5.47."""
    rows, columns = field.shape
    for y in range(rows):
        for x in range(columns):
            bits = reached[y, x]
            total = np.float64(beta[y, x]) * field[y, x]
            if bits & 1:
                total += weight * (field[y, x] - field[y - 1, x])
            if bits & 2:
                total += weight * (field[y, x] - field[y, x + 1])
            if bits & 4:
                total += weight * (field[y, x] - field[y + 1, x])
            if bits & 8:
                total += weight * (field[y, x] - field[y, x - 1])
            out[y, x] = total


@njit(cache=True, nogil=True)
def solve(said, beta, reached, weight, tolerance, field):
    """Minimises Σ β (said - d)² + Σ w (difference)² over float32 ``field``, from what it holds; returns steps.

    Conjugate gradients, preconditioned by the diagonal; a region without any evidence goes flat at its mean.
    """
    rows, columns = field.shape
    guess = field.astype(np.float64)
    residual, image = np.empty((rows, columns)), np.empty((rows, columns))
    diagonal, conditioned = np.empty((rows, columns)), np.empty((rows, columns))
    _applied(guess, beta, reached, weight, image)
    size = 0.0
    for y in range(rows):
        for x in range(columns):
            bits = reached[y, x]
            links = (bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1) + (bits >> 3 & 1)
            diagonal[y, x] = max(beta[y, x] + weight * links, 1e-12)
            wanted = np.float64(beta[y, x]) * said[y, x]
            size += wanted * wanted / diagonal[y, x]
            residual[y, x] = wanted - image[y, x]
            conditioned[y, x] = residual[y, x] / diagonal[y, x]
    way = conditioned.copy()
    now = (residual * conditioned).sum()
    goal = tolerance * tolerance * max(size, 1e-300)
    steps = 0
    while now > goal and steps < 4 * (rows + columns):
        _applied(way, beta, reached, weight, image)
        bent = (way * image).sum()
        if bent <= 0:
            break
        length = now / bent
        guess += length * way
        residual -= length * image
        after = 0.0
        for y in range(rows):
            for x in range(columns):
                conditioned[y, x] = residual[y, x] / diagonal[y, x]
                after += residual[y, x] * conditioned[y, x]
        ratio = after / now
        for y in range(rows):
            for x in range(columns):
                way[y, x] = conditioned[y, x] + ratio * way[y, x]
        now = after
        steps += 1
    for y in range(rows):
        for x in range(columns):
            field[y, x] = guess[y, x]
    return steps
