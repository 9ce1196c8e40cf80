"""The whole layout of a drawing: every box, frame and edge at its place on the page."""

from __future__ import annotations

from dataclasses import dataclass

from visint.graph.drawing.geometry import Block, Frame, Leg, Placed, Point
from visint.graph.drawing.layers import group_block
from visint.graph.drawing.model import Drawing, Edge

__all__ = ["Layout", "lay_out"]

MARGIN = 14.0


@dataclass(frozen=True, slots=True)
class Layout:
    """A drawing with coordinates. Frames stand from the outermost to the innermost."""

    w: float
    h: float
    placed: tuple[Placed, ...]
    frames: tuple[Frame, ...]
    ways: tuple[tuple[Edge, tuple[Leg, ...]], ...]
    spokes: tuple[tuple[str, Point, Point], ...]


def lay_out(drawing: Drawing) -> Layout:
    """``drawing`` laid out; the same for the same spec, wherever and whenever."""
    page = Block(0, 0, frozenset())
    root = group_block(drawing.root, drawing.edges)
    page.take(root, Point(MARGIN, 0))
    legs: dict[Edge, list[Leg]] = {}
    for edge, leg in page.legs:
        legs.setdefault(edge, []).append(leg)
    ways = tuple((edge, _joined(legs[edge])) for edge in drawing.edges if edge in legs)
    frames = tuple(sorted(page.frames, key=lambda frame: -frame.rect.w * frame.rect.h))
    return Layout(root.w + 2 * MARGIN, root.h, tuple(page.placed), frames, ways, tuple(page.spokes))


def _joined(legs: list[Leg]) -> tuple[Leg, ...]:
    """The pieces of an edge in the order in which it runs: each begins where the one before ends."""
    rest, found = list(legs), [_first(legs)]
    rest.remove(found[0])
    while rest:
        end = found[-1].points[-1]
        nearest = min(rest, key=lambda leg: _far(end, leg.points[0]))
        found.append(nearest)
        rest.remove(nearest)
    return tuple(found)


def _first(legs: list[Leg]) -> Leg:
    """The piece that begins where no other ends."""
    ends = [leg.points[-1] for leg in legs]
    return max(
        legs,
        key=lambda leg: min(
            (_far(leg.points[0], end) for end in ends if end is not leg.points[-1]), default=1.0
        ),
    )


def _far(one: Point, other: Point) -> float:
    return abs(one.x - other.x) + abs(one.y - other.y)
