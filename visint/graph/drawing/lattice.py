"""Rows of cells and the links between neighbouring rows: the form in which a layout is ordered and placed.

A cell is a block, or a way by which an edge passes its row. Edges from one port share their ways, so that they
run as one line until they part.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

from visint.graph.drawing.geometry import Block
from visint.graph.drawing.model import Edge

__all__ = ["Cell", "Lattice", "Link", "Route", "lattice"]


@dataclass(eq=False, slots=True)
class Cell:
    """A block in its row, or (without one) a way through the row.

    ``x`` is its left side once placed, ``margin`` is room at its right for edges from the block to itself.
    """

    row: int
    block: Block | None = None
    x: float = 0.0
    margin: float = 0.0

    @property
    def w(self) -> float:
        """Its width; a way has none."""
        return self.block.w + self.margin if self.block else 0.0


class Link(NamedTuple):
    """A piece of an edge from a cell to one in the next row."""

    edge: Edge
    upper: Cell
    lower: Cell

    @property
    def start(self) -> float:
        """Where it leaves the upper cell, from that cell's left side."""
        return self.upper.block.bottom[self.edge] if self.upper.block else 0.0

    @property
    def end(self) -> float:
        """Where it enters the lower cell, from that cell's left side."""
        return self.lower.block.top[self.edge] if self.lower.block else 0.0


class Route(NamedTuple):
    """An edge and its ends: None stands for the outside, above for the source and below for the target."""

    edge: Edge
    source: Cell | None
    target: Cell | None


@dataclass(slots=True)
class Lattice:
    """All rows from the doors at the top to those at the bottom, and each edge's links from top to bottom."""

    rows: list[list[Cell]]
    links: dict[Edge, list[Link]] = field(default_factory=dict)
    ways: dict[tuple[str, str, bool, int], Cell] = field(default_factory=dict)

    def between(self) -> list[list[Link]]:
        """The links that leave each row, each pair of cells and ports once."""
        found: list[dict[tuple[Cell, Cell, float, float], Link]] = [{} for _ in self.rows]
        for links in self.links.values():
            for link in links:
                found[link.upper.row].setdefault((link.upper, link.lower, link.start, link.end), link)
        return [list(row.values()) for row in found]

    def way(self, edge: Edge, row: int) -> Cell:
        """The cell by which ``edge`` passes ``row``."""
        key = (edge.source, edge.out, edge.feedback, row)
        if key not in self.ways:
            self.ways[key] = Cell(row)
            self.rows[row].append(self.ways[key])
        return self.ways[key]


def lattice(cells: Sequence[Cell], routes: Iterable[Route]) -> Lattice:
    """``cells`` in rows 1, 2 …, with the links of ``routes`` and ways for all that pass."""
    depth = max((cell.row for cell in cells), default=0)
    found = Lattice([[] for _ in range(depth + 2)])
    for cell in cells:
        found.rows[cell.row].append(cell)
    for route in routes:
        stops = [*_stops(found, route, depth)]
        pairs = pairwise(stops)
        found.links[route.edge] = [Link(route.edge, upper, lower) for upper, lower in pairs]
    return found


def _stops(found: Lattice, route: Route, depth: int) -> Iterator[Cell]:
    first = route.source.row if route.source else -1
    last = route.target.row if route.target else depth + 2
    if route.source:
        yield route.source
    yield from (found.way(route.edge, row) for row in range(first + 1, last))
    if route.target:
        yield route.target
