"""A hub as a block: the ring, and a way for every edge that enters it, leaves it or runs within it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from visint.graph.drawing.boxes import slots
from visint.graph.drawing.geometry import Block, Leg, Placed, Point, Rect
from visint.graph.drawing.model import Box, Edge, Hub
from visint.graph.drawing.ring import ring, spoke_line

__all__ = ["hub_block"]

TRACK, STEP, STEPS = 9.0, 5.0, 3
LANE = 12.0
CLEAR = 6.0
PAD = 12.0
SKIRT = 20.0


@dataclass(slots=True)
class _Yard:
    """The hub while its ways are laid: the rectangles to keep clear of, and the lanes taken on either side."""

    rects: dict[str, Rect]
    ports: dict[tuple[str, str, str], float]
    lanes: dict[tuple[str, str, bool, bool], float] = field(default_factory=dict)

    def free(self, x: float, top: float, bottom: float) -> bool:
        """Whether one can go down at ``x`` from ``top`` to ``bottom`` without touching a box."""
        return not any(
            rect.x - CLEAR < x < rect.right + CLEAR and rect.y < bottom and top < rect.bottom
            for rect in self.rects.values()
        )

    def lane(self, edge: Edge, x: float) -> float:
        """The x of the lane for ``edge`` on the side of ``x``; edges from one port share it."""
        left = x < 0
        key = (edge.source, edge.out, edge.feedback, left)
        if key not in self.lanes:
            taken = sum(1 for *_, side in self.lanes if side == left)
            edge_of_ring = (
                min(r.x for r in self.rects.values()) if left else max(r.right for r in self.rects.values())
            )
            self.lanes[key] = edge_of_ring + (-1 if left else 1) * LANE * (taken + 1)
        return self.lanes[key]


def hub_block(hub: Hub, edges: Iterable[Edge]) -> Block:
    """``hub`` laid out, with the doors of all ``edges`` that have an end in it."""
    boxes = {box.key: box for box in (hub.map, *hub.spokes)}
    yard = _yard(hub)
    top = min(rect.y for rect in yard.rects.values()) - PAD
    bottom = max(rect.bottom for rect in yard.rects.values()) + SKIRT
    ways = [(edge, _way(yard, edge, boxes, (top, bottom))) for edge in edges]
    ways = [(edge, way) for edge, way in ways if way]
    return _block(hub, yard, ways, (top, bottom))


def _yard(hub: Hub) -> _Yard:
    found = ring(hub)
    boxes = (hub.map, *hub.spokes)
    rects = {box.key: rect for box, rect in zip(boxes, (found.map, *found.spokes), strict=True)}
    return _Yard(rects, {port: x for box in boxes for port, x in _ports(box, rects[box.key])})


def _ports(box: Box, rect: Rect) -> Iterator[tuple[tuple[str, str, str], float]]:
    for side, ports in (("in", box.ins), ("out", box.outs)):
        for port, x in slots(ports, rect.w).items():
            yield (box.key, side, port), rect.x + x


def _way(yard: _Yard, edge: Edge, boxes: dict[str, Box], ends: tuple[float, float]) -> tuple[Point, ...]:
    inside = edge.source in boxes, edge.target in boxes
    if inside == (True, True):
        return _within(yard, edge)
    if inside[1]:
        return _entering(yard, edge, ends[0])
    return _leaving(yard, edge, ends[1]) if inside[0] else ()


def _head(yard: _Yard, edge: Edge) -> tuple[Point, Point]:
    """The edge's end at its target, and the track above it: the nearer its lane, the lower."""
    x, rect = yard.ports[edge.target, "in", edge.into], yard.rects[edge.target]
    others = [at for (key, side, _), at in yard.ports.items() if (key, side) == (edge.target, "in")]
    nearer = sum(1 for at in others if (at < x if x < 0 else at > x))
    return Point(x, rect.y), Point(x, rect.y - TRACK - STEP * min(nearer, STEPS))


def _tail(yard: _Yard, edge: Edge) -> tuple[Point, Point]:
    """The edge's end at its source, and the track below it: one for the left half, one for the right."""
    x, y = yard.ports[edge.source, "out", edge.out], yard.rects[edge.source].bottom
    return Point(x, y), Point(x, y + TRACK + STEP * (x > 0))


def _entering(yard: _Yard, edge: Edge, top: float) -> tuple[Point, ...]:
    end, above = _head(yard, edge)
    if yard.free(end.x, top, end.y):
        return (Point(end.x, top), end)
    x = yard.lane(edge, end.x)
    return (Point(x, top), Point(x, above.y), above, end)


def _leaving(yard: _Yard, edge: Edge, bottom: float) -> tuple[Point, ...]:
    start, below = _tail(yard, edge)
    if yard.free(start.x, start.y, bottom):
        return (start, Point(start.x, bottom))
    x = yard.lane(edge, start.x)
    return (start, below, Point(x, below.y), Point(x, bottom))


def _within(yard: _Yard, edge: Edge) -> tuple[Point, ...]:
    start, below = _tail(yard, edge)
    end, above = _head(yard, edge)
    if start.y < above.y and yard.free(end.x, start.y + 1, end.y):
        return (start, below, Point(end.x, below.y), end)
    x = yard.lane(edge, end.x)
    return (start, below, Point(x, below.y), Point(x, above.y), above, end)


def _block(
    hub: Hub, yard: _Yard, ways: list[tuple[Edge, tuple[Point, ...]]], ends: tuple[float, float]
) -> Block:
    xs = [x for rect in yard.rects.values() for x in (rect.x, rect.right)] + [*yard.lanes.values()]
    left, right = min(xs) - PAD, max(xs) + PAD
    boxes = (hub.map, *hub.spokes)
    block = Block(right - left, ends[1] - ends[0], frozenset(box.key for box in boxes))
    drawn = Block(0, 0, frozenset())
    drawn.placed = [_placed(yard, box) for box in boxes]
    drawn.legs = [(edge, Leg(way, square=True)) for edge, way in ways]
    drawn.spokes = [(s.key, *spoke_line(yard.rects[hub.map.key], yard.rects[s.key])) for s in hub.spokes]
    block.take(drawn, Point(-left, -ends[0]))
    for edge, way in ways:
        if edge.source not in block.keys:
            block.top[edge] = way[0].x - left
        if edge.target not in block.keys:
            block.bottom[edge] = way[-1].x - left
    return block


def _placed(yard: _Yard, box: Box) -> Placed:
    rect = yard.rects[box.key]
    ins = tuple((port, yard.ports[box.key, "in", port]) for port in box.ins)
    outs = tuple((port, yard.ports[box.key, "out", port]) for port in box.outs)
    return Placed(box, rect, ins, outs, "right" if rect.x > 0 else "left")
