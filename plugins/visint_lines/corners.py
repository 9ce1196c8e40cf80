"""Corners of a curve: where its direction before and after a point differ by more than it bends anyway."""

from __future__ import annotations

from functools import cache

import numpy as np

from visint.arrays import Array
from visint_lines.ellipses import off_ellipse, off_line

__all__ = ["corners"]

BLUNT, BLUNTER = 0.6, 0.42
"""Parts of the least turn that do between straight lines, and between straight lines of twice the length."""
FAINT = 0.42
"""Part of the least turn that does where two long straight lines explain it and no ellipse does."""
SIDE, SKIPPED = 24, 3
"""Points of either side that corner and ellipse have to explain, beyond those that smoothing has bent."""
LONG = 14
"""Points on either side that a faint corner needs."""
ROUND, ROUNDEST = 2.0, 0.6
"""Times the error of two lines, and pixels, below which an ellipse explains a sharp turn as well."""
STRAIGHT, UNROUND = 0.25, 0.45
"""Pixels by which lines may miss the sides of a faint corner, and by which an ellipse has to."""


def corners(points: Array, closed: bool, angle: float, window: int = 14) -> list[int]:
    """Indices of the corners of a curve whose points (N, 2) lie a pixel apart.

    Two readings of the turn, each with its own sort of noise: tangents of parabolas, which allow for
    bend of a curve, and straight lines, less the turn that the bend of either side explains. The second is
    made at two lengths: the longer is surer of blunt corners, the shorter of those near others. What turns
    sharply may still be the rim of a cap seen at a low angle: an ellipse explains it, and it is no corner.
    Blunt turns are corners where two straight lines explain them much better.

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
    sharp = np.where(straight > 0.4 * FAINT * angle, sharp, 0.0)[:count]
    if not closed:
        edge = max(4, reach // 3)
        sharp[:edge] = sharp[len(sharp) - edge :] = 0
    found = _peaks(sharp / FAINT, straight[:count], reach, closed)
    return [at for at, strength in found if _holds(points, at, closed, strength * FAINT > 1)]


def _holds(points: Array, at: int, closed: bool, sharp: bool) -> bool:
    """Whether the turn at a point is a corner's and not the bend of an ellipse."""
    before, after = _sides(points, at, closed)
    both = np.concatenate([before, after])
    if len(both) < 6:
        return sharp
    lines = float(((off_line(before) + off_line(after)) / len(both)) ** 0.5)
    ellipse = off_ellipse(both)
    if sharp:
        return ellipse > min(ROUND * lines, ROUNDEST)
    if min(len(before), len(after)) < LONG:
        return False
    return lines < STRAIGHT and ellipse > max(UNROUND, 2.5 * lines)


def _sides(points: Array, at: int, closed: bool) -> tuple[Array, Array]:
    """The points before and after a corner, without those next to it."""
    if closed:
        ring = points[:-1]
        reach = min(SIDE, len(ring) // 2 - 1)
        points, at = np.roll(ring, len(ring) // 2 - at, axis=0), len(ring) // 2
    else:
        reach = SIDE
    low = max(0, at - reach)
    return points[low : max(low, at - SKIPPED + 1)], points[at + SKIPPED : at + reach + 1]


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


def _peaks(sharp: Array, turn: Array, reach: int, closed: bool) -> list[tuple[int, float]]:
    """The sharpest point of each run above 1, placed where the turn of straight lines is largest; how sharp."""
    score = np.where(sharp > 1, sharp, 0.0)
    found: dict[int, float] = {}
    count = len(score)
    while score.max(initial=0.0) > 1:
        peak = int(score.argmax())
        around = np.arange(peak - reach // 2, peak + reach // 2 + 1)
        around = around % count if closed else around[(around >= 0) & (around < count)]
        best = int(around[turn[around].argmax()])
        found[best] = max(found.get(best, 0.0), float(score[peak]))
        for middle in (peak, best):
            gone = np.arange(middle - reach, middle + reach + 1)
            score[gone % count if closed else gone[(gone >= 0) & (gone < count)]] = 0
    return sorted(found.items())
