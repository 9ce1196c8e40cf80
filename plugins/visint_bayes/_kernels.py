# mypy: ignore-errors
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
