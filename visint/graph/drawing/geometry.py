"""Rectangles, points and blocks: what a layout is made of. x to the right, y down, in pixels of the drawing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from visint.graph.drawing.model import Box, Edge, Group

__all__ = ["Block", "Frame", "Leg", "Placed", "Point", "Rect", "shifted"]


class Point(NamedTuple):
    """A point of the drawing."""

    x: float
    y: float


class Rect(NamedTuple):
    """A rectangle by its upper left corner and its size."""

    x: float
    y: float
    w: float
    h: float

    @property
    def right(self) -> float:
        """The x of the right side."""
        return self.x + self.w

    @property
    def bottom(self) -> float:
        """The y of the lower side."""
        return self.y + self.h

    @property
    def middle(self) -> Point:
        """The centre."""
        return Point(self.x + self.w / 2, self.y + self.h / 2)

    def moved(self, by: Point) -> Rect:
        """The same rectangle elsewhere."""
        return Rect(self.x + by.x, self.y + by.y, self.w, self.h)

    def overlaps(self, other: Rect) -> bool:
        """Whether the two share more than a border."""
        across = self.x < other.right and other.x < self.right
        return across and self.y < other.bottom and other.y < self.bottom


class Leg(NamedTuple):
    """A piece of an edge: its corners; ``square`` ones turn at right angles, others in a curve."""

    points: tuple[Point, ...]
    square: bool = False


class Placed(NamedTuple):
    """A box at its place, with the x of its ports: in-ports along its upper side, out-ports along the lower."""

    box: Box
    rect: Rect
    ins: tuple[tuple[str, float], ...]
    outs: tuple[tuple[str, float], ...]
    badge: Literal["left", "right"] = "left"
    """At which corner a spoke's number stands: the one away from the map."""


class Frame(NamedTuple):
    """A loop at its place, and where its caption begins."""

    group: Group
    rect: Rect
    caption: float


@dataclass(slots=True)
class Block:
    """Something laid out, in coordinates of its own: a box, a hub, or a loop with all that is in it.

    ``top`` and ``bottom`` say at which x an edge enters or leaves; ``legs`` holds the pieces of each edge that
    run inside, ``spokes`` the lines between a map and its spokes.
    """

    w: float
    h: float
    keys: frozenset[str]
    top: dict[Edge, float] = field(default_factory=dict)
    bottom: dict[Edge, float] = field(default_factory=dict)
    placed: list[Placed] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    legs: list[tuple[Edge, Leg]] = field(default_factory=list)
    spokes: list[tuple[str, Point, Point]] = field(default_factory=list)

    def take(self, other: Block, at: Point) -> None:
        """Puts all that ``other`` holds into this block, its upper left corner at ``at``."""
        self.placed += [_moved(one, at) for one in other.placed]
        self.frames += [Frame(group, rect.moved(at), x + at.x) for group, rect, x in other.frames]
        self.legs += [(edge, Leg(shifted(leg.points, at), leg.square)) for edge, leg in other.legs]
        self.spokes += [(key, _sum(start, at), _sum(end, at)) for key, start, end in other.spokes]


def shifted(points: Iterable[Point], by: Point) -> tuple[Point, ...]:
    """``points``, each moved ``by`` as much."""
    return tuple(_sum(point, by) for point in points)


def _sum(point: Point, by: Point) -> Point:
    return Point(point.x + by.x, point.y + by.y)


def _moved(one: Placed, by: Point) -> Placed:
    ins = tuple((port, x + by.x) for port, x in one.ins)
    outs = tuple((port, x + by.x) for port, x in one.outs)
    return one._replace(rect=one.rect.moved(by), ins=ins, outs=outs)
