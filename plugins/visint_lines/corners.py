"""Corners of a curve: where its direction before and after a point differ by more than it bends anyway."""

from __future__ import annotations

from functools import cache

import numpy as np

from visint.arrays import Array

__all__ = ["corners"]

BLUNT, BLUNTER = 0.6, 0.42
"""Parts of the least turn that do between straight lines, and between straight lines of twice the length."""


def corners(points: Array, closed: bool, angle: float, window: int = 14) -> list[int]:
    """Indices of the corners of a curve whose points (N, 2) lie a pixel apart.

    Two readings of the turn, each with its own sort of noise: tangents of parabolas, which allow for
    bend of a curve, and straight lines, less the turn that the bend of either side explains. The second is
    made at two lengths: the longer is surer of blunt corners, the shorter of those near others.

    Parameters
    ----------
    angle
        The least turn, radians, of a corner between bent sides; about half of it does between straight ones.
        Less finds more and calls bends corners.
    window
        Points on each side that say the direction; twice as many where there are.
    """
    count = len(points) - 1 if closed else len(points)
    reach = min(window, (count - 1) // 2)
    if reach < 5:
        return []
    bent, straight, excess = _turns(points, closed, reach)
    sharp = np.maximum(bent / angle, excess / (BLUNT * angle))
    if count > 4 * reach:
        sharp = np.maximum(sharp, _turns(points, closed, 2 * reach)[2] / (BLUNTER * angle))
    sharp = np.where(straight > 0.4 * angle, sharp, 0.0)[:count]
    if not closed:
        edge = max(4, reach // 3)
        sharp[:edge] = sharp[len(sharp) - edge :] = 0
    return _peaks(sharp, straight[:count], reach, closed)


def _extended(points: Array, closed: bool, reach: int) -> Array:
    """The curve with ``reach`` points more at each end: round the loop, or straight on."""
    if closed:
        ring = points[:-1]
        return np.concatenate([ring[-reach:], ring, ring[:reach]])
    before, after = 2 * points[0] - points[reach:0:-1], 2 * points[-1] - points[-2 : -reach - 2 : -1]
    return np.concatenate([before, points, after])


@cache
def _weights(reach: int, degree: int, term: int) -> Array:
    """(reach,): times points 1 to ``reach`` away it is a term of the polynomial of t fitted to them."""
    t = np.arange(1, reach + 1, dtype=np.float64)
    return np.asarray(np.linalg.pinv(np.stack([t**k for k in range(degree + 1)], axis=-1))[term])


def _turns(points: Array, closed: bool, reach: int) -> tuple[Array, Array, Array]:
    """(turn between parabolas' tangents, between lines, what of that no bend explains) at each point."""
    wide = _extended(points, closed, reach)
    views = np.lib.stride_tricks.sliding_window_view(wide, 2 * reach + 1, axis=0)  # (N, 2, 2·reach + 1)
    before, after = views[..., reach - 1 :: -1], views[..., reach + 1 :]
    bent = _between(-(before @ _weights(reach, 2, 1)), after @ _weights(reach, 2, 1))
    one, two = -(before @ _weights(reach, 1, 1)), after @ _weights(reach, 1, 1)
    lines = _between(one, two)
    bend = np.maximum(_bend(one, before @ _weights(reach, 2, 2)), _bend(two, after @ _weights(reach, 2, 2)))
    return bent, lines, lines - (reach + 1) * bend


def _between(one: Array, two: Array) -> Array:
    cross = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    return np.asarray(np.abs(np.arctan2(cross, (one * two).sum(axis=1))))


def _bend(slope: Array, second: Array) -> Array:
    """Curvature, radians a pixel, from the slope and half the second derivative of a side."""
    cross = slope[:, 0] * second[:, 1] - slope[:, 1] * second[:, 0]
    speed = np.maximum((slope**2).sum(axis=1), 1e-6)
    return np.asarray(2 * np.abs(cross) / speed**1.5)


def _peaks(sharp: Array, turn: Array, reach: int, closed: bool) -> list[int]:
    """The sharpest point of each run above 1, placed where the turn of straight lines is largest."""
    score = np.where(sharp > 1, sharp, 0.0)
    found: list[int] = []
    count = len(score)
    while score.max(initial=0.0) > 1:
        peak = int(score.argmax())
        around = np.arange(peak - reach // 2, peak + reach // 2 + 1)
        around = around % count if closed else around[(around >= 0) & (around < count)]
        best = int(around[turn[around].argmax()])
        found.append(best)
        for middle in (peak, best):
            gone = np.arange(middle - reach, middle + reach + 1)
            score[gone % count if closed else gone[(gone >= 0) & (gone < count)]] = 0
    return sorted(set(found))
