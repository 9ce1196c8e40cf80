"""The ways of edges that come back: down from the source, aside, up a lane, aside, down into the target."""

from __future__ import annotations

from dataclasses import dataclass, field

from visint.graph.drawing.floor import LANE, Floor, Return
from visint.graph.drawing.geometry import Leg, Point
from visint.graph.drawing.lattice import Lattice

__all__ = ["TRACK", "Lanes", "lanes_of", "return_leg"]

TRACK = 9.0


@dataclass(slots=True)
class Lanes:
    """What returning edges take up: x of the lane of each, and the tracks in the gap below each row."""

    xs: dict[Return, float] = field(default_factory=dict)
    low: dict[Return, int] = field(default_factory=dict)
    high: dict[Return, int] = field(default_factory=dict)
    tracks: dict[int, int] = field(default_factory=dict)

    @property
    def right(self) -> float:
        """How far the lanes reach."""
        return max(self.xs.values(), default=0.0)


def lanes_of(floor: Floor, found: Lattice) -> Lanes:
    """A lane for every returning edge, at the right of the rows that it passes, shorter ones further in."""
    lanes = Lanes()
    for one in sorted(floor.returns, key=lambda one: one.source.row - one.target.row):
        lanes.xs[one] = _lane(lanes, found, one)
        lanes.low[one] = _track(lanes, one.source.row)
        lanes.high[one] = _track(lanes, one.target.row - 1)
    return lanes


def _track(lanes: Lanes, gap: int) -> int:
    lanes.tracks[gap] = lanes.tracks.get(gap, 0) + 1
    return lanes.tracks[gap]


def _lane(lanes: Lanes, found: Lattice, one: Return) -> float:
    if one.source is one.target and one.source.block is not None:
        mine = sum(1 for other in lanes.xs if other.source is other.target is one.source)
        return one.source.x + one.source.block.w + LANE * (mine + 1)
    upper, lower = sorted((one.source.row, one.target.row))
    free = LANE + max(cell.x + cell.w for row in found.rows[upper : lower + 1] for cell in row)
    while any(abs(free - taken) < LANE - 1 for taken in lanes.xs.values()):
        free += LANE
    return free


def return_leg(floor: Floor, lanes: Lanes, one: Return) -> Leg:
    """The way of the returning edge ``one``."""
    source, target, lane = one.source, one.target, lanes.xs[one]
    assert source.block is not None
    assert target.block is not None
    x0, x1 = source.x + source.block.bottom[one.edge], target.x + target.block.top[one.edge]
    low = floor.bottoms[source.row] + TRACK * lanes.low[one]
    high = floor.tops[target.row] - TRACK * lanes.high[one] - 4
    start, end = Point(x0, floor.tops[source.row] + source.block.h), Point(x1, floor.tops[target.row])
    return Leg((start, Point(x0, low), Point(lane, low), Point(lane, high), Point(x1, high), end), square=True)
