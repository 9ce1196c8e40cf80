"""A group on its way to a layout: its blocks in rows, its edges sorted into going down and coming back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from visint.graph.drawing.boxes import place_ports
from visint.graph.drawing.geometry import Block
from visint.graph.drawing.lattice import Cell, Lattice, Route
from visint.graph.drawing.model import Box, Edge
from visint.graph.drawing.ranks import forward, ranks

__all__ = ["Floor", "Return", "floor_of", "sort_ports"]

LANE = 12.0
End = int | None


@dataclass(frozen=True, slots=True)
class Return:
    """An edge that comes back, or stays at its box: both its ends are blocks of the group."""

    edge: Edge
    source: Cell
    target: Cell


@dataclass(slots=True)
class Floor:
    """The cells of a group, its edges, and the y of every row once it is known."""

    cells: list[Cell]
    routes: list[Route] = field(default_factory=list)
    returns: list[Return] = field(default_factory=list)
    tops: list[float] = field(default_factory=list)
    bottoms: list[float] = field(default_factory=list)

    @property
    def keys(self) -> frozenset[str]:
        """The keys of all boxes in it."""
        return frozenset(key for cell in self.cells if cell.block for key in cell.block.keys)


def floor_of(blocks: Sequence[Block], edges: Sequence[Edge]) -> Floor:
    """``blocks`` in rows by the longest path, with all ``edges`` that have an end among them."""
    home = {key: index for index, block in enumerate(blocks) for key in block.keys}
    ends = [(edge, home.get(edge.source), home.get(edge.target)) for edge in edges]
    ends = [(edge, s, t) for edge, s, t in ends if _concerns(blocks, s, t)]
    pairs = [(s, t) for edge, s, t in ends if s is not None and t is not None and not edge.feedback]
    down = forward(pairs)
    rows = ranks(len(blocks), down, _with_role(blocks, "input", "missing"), _with_role(blocks, "output"))
    floor = Floor([Cell(row + 1, block) for row, block in zip(rows, blocks, strict=True)])
    kept = set(down)
    for edge, s, t in ends:
        _sort_in(floor, edge, (s, t), s is None or t is None or (not edge.feedback and (s, t) in kept))
    for cell in floor.cells:
        cell.margin = LANE * sum(1 for one in floor.returns if one.source is one.target is cell)
    return floor


def _sort_in(floor: Floor, edge: Edge, ends: tuple[End, End], down: bool) -> None:
    source, target = (None if end is None else floor.cells[end] for end in ends)
    if down:
        floor.routes.append(Route(edge, source, target))
    elif source is not None and target is not None:
        floor.returns.append(Return(edge, source, target))


def _concerns(blocks: Sequence[Block], source: End, target: End) -> bool:
    """Whether an edge is this group's: one within a loop or a hub was drawn there, one outside is not yet."""
    if source is None or target is None:
        return source != target
    return source != target or _lone(blocks[source])


def _lone(block: Block) -> bool:
    """Whether it is a single box, neither a loop nor a hub (be it one without spokes)."""
    return len(block.placed) == 1 and not block.frames and block.placed[0].box.role != "map"


def _with_role(blocks: Sequence[Block], *roles: str) -> list[int]:
    return [i for i, block in enumerate(blocks) if _lone(block) and block.placed[0].box.role in roles]


def sort_ports(floor: Floor, found: Lattice, boxes: Sequence[Box], edges: Sequence[Edge]) -> None:
    """Puts the ports of each of ``boxes`` in the order in which their edges arrive."""
    arrive, leave = _meetings(found)
    blocks = {
        cell.block.placed[0].box.key: cell.block for cell in floor.cells if cell.block and cell.block.placed
    }
    for box in boxes:
        ins = sorted(box.ins, key=lambda port: _mean(arrive.get((box.key, port))))
        outs = sorted(box.outs, key=lambda port: _mean(leave.get((box.key, port))))
        place_ports(blocks[box.key], box, (ins, outs), edges)


Meetings = dict[tuple[str, str], list[float]]


def _meetings(found: Lattice) -> tuple[Meetings, Meetings]:
    """Where the edges into, and out of, each port come from or go to."""
    arrive: Meetings = {}
    leave: Meetings = {}
    for edge, links in found.links.items():
        first, last = links[0], links[-1]
        arrive.setdefault((edge.target, edge.into), []).append(last.upper.x + last.start)
        leave.setdefault((edge.source, edge.out), []).append(first.lower.x + first.end)
    return arrive, leave


def _mean(xs: Sequence[float] | None) -> float:
    """The mean of ``xs``; a port that only returning edges use stands at the right, where their lanes are."""
    return sum(xs) / len(xs) if xs else float("inf")
