"""What is drawn, before any coordinate: boxes nested as the loops are, a hub, and the edges between ports."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

__all__ = ["Box", "Drawing", "Edge", "Group", "Hub", "Role"]

Role = Literal["input", "node", "spoke", "map", "output", "missing"]


@dataclass(frozen=True, slots=True)
class Box:
    """A box: ``text`` is its second line, ``ins`` and ``outs`` are the ports that have an edge.

    ``missing`` is the role of a reference that points nowhere: a graph can be drawn before it is right.
    """

    key: str
    role: Role
    name: str
    text: str = ""
    tip: str = ""
    ins: tuple[str, ...] = ()
    outs: tuple[str, ...] = ()
    turn: int = 0
    """A spoke's place in the hub's order, from 1."""


@dataclass(frozen=True, slots=True)
class Edge:
    """From port ``out`` of the box ``source`` to port ``into`` of the box ``target``."""

    source: str
    out: str
    target: str
    into: str
    feedback: bool = False


@dataclass(frozen=True, slots=True)
class Hub:
    """The map and the spokes around it, in order; each of them reads the map and writes it."""

    map: Box
    spokes: tuple[Box, ...]


@dataclass(frozen=True, slots=True)
class Group:
    """A loop with what lies in it; the graph itself is the outermost group, which has no frame."""

    name: str = ""
    caption: tuple[str, ...] = ()
    boxes: tuple[Box, ...] = ()
    groups: tuple[Group, ...] = ()
    hub: Hub | None = None
    framed: bool = True

    def own(self) -> Iterator[Box]:
        """The boxes directly in it, the hub's included."""
        yield from self.boxes
        if self.hub is not None:
            yield self.hub.map
            yield from self.hub.spokes

    def every(self) -> Iterator[Box]:
        """All boxes in it, at any depth."""
        yield from self.own()
        for group in self.groups:
            yield from group.every()


@dataclass(frozen=True, slots=True)
class Drawing:
    """A graph as it is drawn; ``failed`` is the key of the box to draw red, or empty."""

    name: str
    about: str
    root: Group
    edges: tuple[Edge, ...]
    failed: str = ""
