"""Line diagrams: junctions, the arcs between them, and what was measured along each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi, tau
from typing import ClassVar, NamedTuple

import numpy as np

from visint.arrays import Array, read_only

__all__ = ["Arc", "Diagram", "Junction", "Measures", "Spoke", "assembled"]

LOOP = -1
"""The junction at both ends of a closed arc."""


class Measures(NamedTuple):
    """What depth says of an arc (Table 4.2).

    Parameters
    ----------
    gap
        How much nearer the left side is than the right one, at the arc itself, in pixels: f ΔZ/Z.
    spread
        One standard error of the gap, pixels.
    dihedral
        By how much the two faces bend at the arc, radians; convex is positive.
    spread_dihedral
        One standard error of the dihedral angle, radians.
    left, right
        Limbness, in [0, 1]: the share of points at which the surface on that side turns away as a limb does.
    seen
        The share of points at which depth is known on both sides, beyond where it is blurred.
    """

    gap: float = 0.0
    spread: float = float("inf")
    dihedral: float = 0.0
    spread_dihedral: float = float("inf")
    left: float = 0.0
    right: float = 0.0
    seen: float = 0.0

    @property
    def limbness(self) -> float:
        """Of the side that is more of a limb."""
        return max(self.left, self.right)


@dataclass(frozen=True, eq=False)
class Arc:
    """A line between two junctions.

    Parameters
    ----------
    start, end
        Numbers of the junctions; both -1 where the arc is closed and has none.
    left, right
        The regions on either hand as one walks from start to end, seen on the screen; 0 is unknown.
    points
        float64 (N, 2): column and row of points about a pixel apart, from start to end.
    background
        Whether it borders the region that surrounds everything: ``"left"``, ``"right"`` or ``""``.
    measures
        What depth says of it; None before anybody asked.
    """

    start: int
    end: int
    left: int
    right: int
    points: Array
    background: str = ""
    measures: Measures | None = None

    @property
    def length(self) -> float:
        """In pixels."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())

    @property
    def closed(self) -> bool:
        """Whether it has no junction at all."""
        return self.start == LOOP


class Spoke(NamedTuple):
    """One end of an arc at a junction: which arc, whether it starts here, and its direction away from here.

    ``angle``: radians, counter-clockwise as seen on the screen, from the right.
    """

    arc: int
    outward: bool
    angle: float


class Junction(NamedTuple):
    """A point where arcs meet: column, row, and its arcs counter-clockwise as seen.

    ``frame`` says that the line just leaves the image here; ``smooth``, that two arcs meet without a corner,
    because something else than their direction changes.
    """

    x: float
    y: float
    spokes: tuple[Spoke, ...]
    frame: bool = False
    smooth: bool = False

    @property
    def angles(self) -> tuple[float, ...]:
        """Directions of the arcs away from here, ascending."""
        return tuple(spoke.angle for spoke in self.spokes)


@dataclass(frozen=True, eq=False)
class Diagram:
    """A line drawing as a graph. ``size``: (rows, columns) of the image it was parsed from."""

    __kind__: ClassVar[str] = "lines.Diagram"

    size: tuple[int, int]
    junctions: tuple[Junction, ...] = ()
    arcs: tuple[Arc, ...] = ()

    def ends(self) -> Iterator[tuple[int, Spoke]]:
        """(junction, spoke) of every end of every arc."""
        for number, junction in enumerate(self.junctions):
            for spoke in junction.spokes:
                yield number, spoke

    def scaled(self, factor: float, size: tuple[int, int]) -> Diagram:
        """The diagram on a raster whose pixels are ``factor`` times as many along each side."""
        arcs = tuple(replace(a, points=read_only((a.points + 0.5) * factor - 0.5)) for a in self.arcs)
        nodes = tuple(
            j._replace(x=(j.x + 0.5) * factor - 0.5, y=(j.y + 0.5) * factor - 0.5) for j in self.junctions
        )
        return Diagram(size, nodes, arcs)


def assembled(
    size: tuple[int, int],
    places: Array,
    arcs: list[Arc],
    angles: list[tuple[float, float]],
    frame: Array,
    smooth: Array | None = None,
) -> Diagram:
    """A diagram from its arcs and the directions in which each leaves its start and its end.

    Parameters
    ----------
    places
        float (J, 2): column and row of each junction.
    angles
        For each arc its direction away from its start and away from its end, radians, y up.
    frame
        bool (J,): where a line leaves the image.
    smooth
        bool (J,): where arcs meet without a corner.
    """
    spokes: list[list[Spoke]] = [[] for _ in places]
    for number, (arc, (away, back)) in enumerate(zip(arcs, angles, strict=True)):
        if not arc.closed:
            spokes[arc.start].append(Spoke(number, True, _turn(away)))
            spokes[arc.end].append(Spoke(number, False, _turn(back)))
    even = smooth if smooth is not None else np.zeros(len(places), dtype=bool)
    junctions = tuple(
        Junction(float(x), float(y), tuple(sorted(own, key=lambda one: one.angle)), bool(edge), bool(flat))
        for (x, y), own, edge, flat in zip(places, spokes, frame, even, strict=True)
    )
    return Diagram(size, junctions, tuple(arcs))


def _turn(angle: float) -> float:
    """In (−π, π]."""
    return pi - (pi - angle) % tau
