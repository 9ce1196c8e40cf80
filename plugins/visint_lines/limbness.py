"""Limbness: does a surface turn away from the viewer towards its boundary, as at a limb?"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["LEAST", "LimbPoints", "limb_points", "limb_runs", "withdrawn"]

LEAST = 6
"""Samples below which nothing is said."""
FEWEST = 5
"""Of them those before the surface has turned to face the viewer; fewer are no limb's."""
FACING = 0.0
"""The angle below which it has: what lies beyond is about another side of the surface."""
FIRST = 3
"""Samples next to the boundary whose mean is the starting angle."""
DROP = np.radians(3.0)
"""By how much the angle falls over the samples of a limb, whose radius may be some hundred pixels."""
BENT = 0.7
"""Part of the least starting angle that the samples themselves must have."""
LOWEST = np.radians(75.0)
"""Mean angle at which two samples do for a limb, where there are too few for the tests."""
CLOSE = np.radians(83.0)
"""Angle at the boundary below which a stretch of limb has ended, though what follows still looks like one."""
GRAIN = np.radians(1.0)
"""Angles are rounded to this before they are ranked: ranks of rounding errors are noise."""
HIT, FALSE = 0.85, 0.04
"""Share of the points of a limb, and of other lines, that pass both tests."""
HIT_BLURRED, FALSE_BLURRED = 0.7, 0.1
"""The same of blurred depth, where neighbouring points err together and each says less."""
CHANGE = 10.0
"""What it costs, in nats, that a line changes between limb and none: about five points' worth."""


class LimbPoints(NamedTuple):
    """``passed``, ``asked``: bool (...), whether it is a limb, and whether anything could be said.

    ``edge``: float (...), radians, the angle at the boundary itself.
    """

    passed: Array
    asked: Array
    edge: Array


def limb_points(slant: Array, offset: Array, size: float, start: float, sharp: bool = True) -> LimbPoints:
    """Whether angles (..., M), by distance from the boundary, pass both tests of section 4.1.3, which at least
    :data:`LEAST` of them can.

    The trend: Spearman's rank correlation S of angle and distance is negative, R = S √((m−2)/(1−S²)) below the
    ``size`` quantile of Student's t, one-sided; and from end to end the angle falls by :data:`DROP` at least,
    which the trend of a plane in smoothed noise does not. The start: the mean of the first angles is above
    ``start`` (radians), or it is where the circle through them meets the boundary: near a thin limb the surface
    has turned to the viewer after few pixels. Ties have mean ranks; NaN is no sample.
    """
    known = np.isfinite(slant)
    asked = known.sum(axis=-1) >= LEAST
    known &= np.cumsum(known & (slant < FACING), axis=-1) == 0
    count = known.sum(axis=-1)
    angle = np.where(known, np.rint(slant / GRAIN), 0)
    distance = np.broadcast_to(np.arange(slant.shape[-1], dtype=np.float64), slant.shape)
    trend = _correlation(_ranks(angle, known), _ranks(distance, known), known)
    rank = known.cumsum(axis=-1)
    begin = _mean(slant, known & (rank <= FIRST))
    end = _mean(slant, known & (rank > count[..., None] - FIRST))
    there = _at_boundary(slant, known, offset)
    begins = np.maximum(begin, np.where(begin > _bent(known, offset) * start, there, 0))
    critical = np.array([_critical(m, size) for m in range(slant.shape[-1] + 1)])
    passed = (trend < critical[count]) & (begin - end > DROP) & (begins > start) & (count >= FEWEST)
    low = ~asked & (count >= 2) & (begin > LOWEST) & sharp
    return LimbPoints(passed & asked | low, asked | low, there)


def _mean(value: Array, where: Array) -> Array:
    return np.asarray(np.where(where, value, 0).sum(axis=-1) / np.maximum(where.sum(axis=-1), 1))


def _bent(known: Array, offset: Array) -> Array:
    """Part of the least starting angle that the first samples must have: less where they lie further in."""
    first = np.where(known, offset, np.inf).min(axis=-1, initial=np.inf)
    return np.asarray(BENT / np.maximum(first, 1) ** 0.6)


def _at_boundary(slant: Array, known: Array, offset: Array) -> Array:
    """The angle at the boundary itself, by the trend: on a round surface its sine is linear in distance."""
    weight = known.astype(np.float64)
    sine = np.where(known, np.sin(slant), 0)
    total = np.maximum(weight.sum(axis=-1), 1)
    mean_x, mean_y = (weight * offset).sum(axis=-1) / total, sine.sum(axis=-1) / total
    away = (offset - mean_x[..., None]) * weight
    slope = (away * sine).sum(axis=-1) / np.maximum((away**2).sum(axis=-1), 1e-9)
    return np.asarray(np.arcsin(np.clip(mean_y - slope * mean_x, -1, 1)))


def _ranks(value: Array, known: Array) -> Array:
    """Mean ranks along the last axis among the known."""
    one, two = value[..., :, None], value[..., None, :]
    below = ((two < one) + 0.5 * (two == one)) * known[..., None, :]
    return np.asarray(below.sum(axis=-1))


def _correlation(one: Array, two: Array, known: Array) -> Array:
    weight = known.astype(np.float64)
    total = np.maximum(weight.sum(axis=-1, keepdims=True), 1)
    a = (one - (one * weight).sum(axis=-1, keepdims=True) / total) * weight
    b = (two - (two * weight).sum(axis=-1, keepdims=True) / total) * weight
    scale = np.sqrt((a * a).sum(axis=-1) * (b * b).sum(axis=-1))
    return np.asarray((a * b).sum(axis=-1) / np.where(scale > 0, scale, 1))


@cache
def _critical(count: int, size: float) -> float:
    """The S whose R is the ``size`` quantile of t with ``count`` − 2 degrees of freedom."""
    from scipy.special import stdtrit

    if count < FEWEST:
        return -2.0
    t = float(stdtrit(count - 2, size))
    return float(t / (count - 2 + t * t) ** 0.5)


def limb_runs(passed: Array, asked: Array, closed: bool, blur: float = 0.0) -> list[tuple[int, int, bool]]:
    """(first, behind the last, whether limb) of the runs into which points fall, bool (N,), along a line.

    Points that were not asked go with their neighbours. The cheapest explanation by limb and other stretches,
    each change having its price, a higher one in blurred depth. On a closed line the first run may begin
    anywhere; then its last index lies beyond N.
    """
    count = len(passed)
    if count == 0:
        return []
    hit, false = (HIT_BLURRED, FALSE_BLURRED) if blur else (HIT, FALSE)
    cost = -np.log(np.where(passed[:, None], [false, hit], [1 - false, 1 - hit])) * asked[:, None]
    change = CHANGE * (1 + blur / 4)
    states = _cheapest(np.tile(cost, (3, 1)), change)[count : 2 * count] if closed else _cheapest(cost, change)
    cuts = np.flatnonzero(np.diff(states.astype(np.int8))) + 1
    if not closed or not len(cuts):
        edges = [0, *cuts.tolist(), count]
        return [(a, b, bool(states[a])) for a, b in pairwise(edges)]
    seamless = states[0] == states[-1]  # the run across the seam is one
    edges = [*cuts.tolist(), int(cuts[0]) + count] if seamless else [0, *cuts.tolist(), count]
    return [(a, b, bool(states[a % count])) for a, b in pairwise(edges)]


def withdrawn(runs: list[tuple[int, int, bool]], edge: Array, closed: bool) -> list[int]:
    """Where ``runs`` begin, with limbs drawn back to where the surface is seen edge-on at the boundary.

    The rim that a limb passes into is at first seen at almost as low an angle. ``edge``: float (N,), the angle
    at the boundary of each point. An open line's first run begins at its end in any case.
    """
    starts = [first for first, _, _ in runs]
    for i, (first, behind, limb) in enumerate(runs):
        on = _even(edge[np.arange(first, behind) % len(edge)]) > CLOSE
        if not limb or len(runs) < 2 or not on.any():
            continue
        if closed or i > 0:
            starts[i] += int(on.argmax())
        if closed or i + 1 < len(runs):
            starts[(i + 1) % len(runs)] = behind - int(on[::-1].argmax())
    return starts


def _even(value: Array) -> Array:
    """The median of each and its four neighbours."""
    wide = np.pad(value, 2, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(wide, 5), axis=-1))


def _cheapest(cost: Array, change: float) -> Array:
    """bool (N,): the states with the least sum of cost (N, 2) and changes (Viterbi)."""
    total, back = cost[0].copy(), np.zeros((len(cost), 2), np.int64)
    for i in range(1, len(cost)):
        switched = total[::-1] + change
        back[i] = np.where(switched < total, [1, 0], [0, 1])
        total = np.minimum(total, switched) + cost[i]
    states = np.empty(len(cost), bool)
    state = int(total.argmin())
    for i in range(len(cost) - 1, -1, -1):
        states[i] = state == 1
        state = int(back[i, state])
    return states
