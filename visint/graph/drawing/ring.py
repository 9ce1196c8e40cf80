"""The hub's layout: the map in the middle, its spokes around it in order, clockwise from the lower left.

Spokes stand in rows of two, left and right, so that every edge has a free way: the gaps between the rows, and
the lanes outside them. The gap at the bottom is left to what the map gives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from visint.graph.drawing.boxes import box_size, slots
from visint.graph.drawing.geometry import Point, Rect
from visint.graph.drawing.model import Box, Hub

__all__ = ["GAP", "Ring", "ring", "spoke_line"]

GAP = 40.0
SPOKE = 48.0
"""The least length of the line between the map and a spoke beside it."""


class Ring(NamedTuple):
    """The rectangles of the map and the spokes, about the map's centre as origin."""

    map: Rect
    spokes: tuple[Rect, ...]


class _Size(NamedTuple):
    """Width and height of the map and of every spoke (all are as large as the largest), and how many rows."""

    map: tuple[float, float]
    spoke: tuple[float, float]
    rows: int


def ring(hub: Hub) -> Ring:
    """Where the map and the spokes of ``hub`` stand."""
    count = len(hub.spokes)
    sizes = [box_size(spoke) for spoke in hub.spokes] or [(0.0, 0.0)]
    most = max(w for w, _ in sizes), max(h for _, h in sizes)
    size = _Size(box_size(hub.map), most, (count + 1) // 2)
    ys = _rows(size, count)
    xs = [_reach(size, y, hub.map) for y in ys]
    spots = [_spot(index, count, xs, ys) for index in range(count)]
    return Ring(_about(Point(0, 0), size.map), tuple(_about(spot, size.spoke) for spot in spots))


def _about(centre: Point, size: tuple[float, float]) -> Rect:
    w, h = size
    return Rect(centre.x - w / 2, centre.y - h / 2, w, h)


def _rows(size: _Size, count: int) -> list[float]:
    """The y of each row's centre; the map stands on the middle row, or between the two middle ones."""
    pitch = size.spoke[1] + GAP
    beside = size.rows % 2 == 1 and count > 1
    room = max(0.0, (size.map[1] - size.spoke[1]) / 2 if beside else size.map[1] / 2 + GAP / 2 - 2)
    if count == 1:
        return [-(size.map[1] + size.spoke[1]) / 2 - SPOKE]
    half = (size.rows - 1) / 2
    return [(row - half) * pitch + math.copysign(room, row - half) * (row != half) for row in range(size.rows)]


def _reach(size: _Size, y: float, middle: Box) -> float:
    """How far from the axis the centres of the row at ``y`` stand: on an ellipse, but clear of the map."""
    (map_w, map_h), (w, h) = size.map, size.spoke
    tall = size.rows * (h + GAP) / 2 + map_h / 2
    wide = map_w / 2 + SPOKE + w / 2
    least = w / 2 + (44 if middle.ins else 16)
    if y > 0:
        ways = slots(middle.outs, map_w).values()
        least = max(least, w / 2 + 20 + (max(ways) - min(ways) if ways else 0) / 2)
    if abs(y) < (map_h + h) / 2 + 4:
        return wide
    return max(least, wide * math.sqrt(max(0.0, 1 - (y / tall) ** 2)))


def _spot(index: int, count: int, xs: Sequence[float], ys: Sequence[float]) -> Point:
    """The centre of spoke ``index`` of ``count``; an odd one out stands at the top, on the axis."""
    half, rows = count // 2, len(ys)
    if index < half:
        return Point(-xs[rows - 1 - index], ys[rows - 1 - index])
    if count % 2 and index == half:
        return Point(0.0, ys[0])
    row = index - half
    return Point(xs[row], ys[row])


def spoke_line(middle: Rect, spoke: Rect) -> tuple[Point, Point]:
    """The line from the map, a rectangle with round ends, to the nearest place on a spoke."""
    end = _nearest(middle.middle, spoke)
    radius = middle.h / 2
    flat = max(0.0, middle.w / 2 - radius)
    axis = Point(middle.middle.x + min(max(end.x - middle.middle.x, -flat), flat), middle.middle.y)
    far = math.hypot(end.x - axis.x, end.y - axis.y)
    share = radius / far
    return Point(axis.x + (end.x - axis.x) * share, axis.y + (end.y - axis.y) * share), end


def _nearest(point: Point, rect: Rect) -> Point:
    """The point of ``rect`` nearest to ``point``, a little off its round corners."""
    inset = 12.0 if not rect.y <= point.y <= rect.bottom else 0.0
    x = min(max(point.x, rect.x + inset), rect.right - inset)
    return Point(x, min(max(point.y, rect.y), rect.bottom))
