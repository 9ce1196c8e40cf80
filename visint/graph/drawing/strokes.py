"""Edges as SVG path data: curves that leave and arrive upright, square ways with round corners, arrowheads."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from visint.graph.drawing.geometry import Leg, Point

__all__ = ["arrowhead", "number", "path"]

ROUND = 7.0
LONG, BROAD = 7.5, 3.4


def number(x: float) -> str:
    """``x`` to a tenth of a pixel, without a needless zero."""
    return f"{round(x, 1) + 0.0:g}" if abs(x) < 1e5 else f"{x:.1f}"


def _at(point: Point) -> str:
    return f"{number(point.x)},{number(point.y)}"


def path(legs: Sequence[Leg]) -> str:
    """Path data along ``legs``, one after the other."""
    return f"M{_at(legs[0].points[0])}" + "".join(step for leg in legs for step in _steps(leg))


def _steps(leg: Leg) -> Iterator[str]:
    if leg.square:
        yield from _square(_corners(leg.points))
        return
    for one, other in pairwise(leg.points):
        middle = (one.y + other.y) / 2
        if abs(one.x - other.x) < 0.05:
            yield f"L{_at(other)}"
        else:
            yield f"C{_at(Point(one.x, middle))} {_at(Point(other.x, middle))} {_at(other)}"


def _corners(points: Sequence[Point]) -> list[Point]:
    """``points`` without those that follow so closely that no corner could be rounded between."""
    kept = [points[0]]
    for point in points[1:]:
        if math.dist(point, kept[-1]) > 0.05:
            kept.append(point)
    return kept


def _square(points: Sequence[Point]) -> Iterator[str]:
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        radius = min(ROUND, math.dist(before, corner) / 2, math.dist(corner, after) / 2)
        yield f"L{_at(_towards(corner, before, radius))}"
        yield f"Q{_at(corner)} {_at(_towards(corner, after, radius))}"
    yield f"L{_at(points[-1])}"


def _towards(start: Point, goal: Point, far: float) -> Point:
    share = far / math.dist(start, goal)
    return Point(start.x + (goal.x - start.x) * share, start.y + (goal.y - start.y) * share)


def arrowhead(start: Point, tip: Point) -> str:
    """Path data of an arrowhead at ``tip`` that comes from ``start``."""
    far = math.dist(start, tip) or 1.0
    x, y = (tip.x - start.x) / far, (tip.y - start.y) / far
    foot = Point(tip.x - LONG * x, tip.y - LONG * y)
    sides = Point(foot.x - BROAD * y, foot.y + BROAD * x), Point(foot.x + BROAD * y, foot.y - BROAD * x)
    return f"M{_at(tip)}L{_at(sides[0])}L{_at(sides[1])}Z"
