"""The size of a single box and the places of its ports."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from visint.graph.drawing.geometry import Block, Placed, Rect
from visint.graph.drawing.lettering import fitted, widest, width
from visint.graph.drawing.model import Box, Edge

__all__ = ["NAME", "PORT", "TEXT", "box_block", "box_size", "place_ports", "slots"]

NAME, TEXT, PORT = 13.0, 10.5, 9.0
"""Sizes of the letters: a box's name, its second line, its ports."""
TALL, LOW = 66.0, 40.0
MAP_EXTRA = 14.0
GAP = 12.0


def box_size(box: Box) -> tuple[float, float]:
    """Width and height of ``box``, wide enough for every line that stands in it."""
    words = max(width(fitted(box.name), NAME, bold=True) + 24 * bool(box.turn), width(fitted(box.text), TEXT))
    w = max(words, _row(box.ins), _row(box.outs)) + 24
    if box.role == "map":
        return max(w + 36, 150.0), TALL + MAP_EXTRA
    return max(w, 64.0), LOW if box.role in ("input", "output") else TALL


def _row(ports: Iterable[str]) -> float:
    shown = [fitted(port, 28) for port in ports]
    return sum(width(port, PORT) for port in shown) + GAP * max(len(shown) - 1, 0)


def slots(ports: Sequence[str], w: float) -> dict[str, float]:
    """The x of each of ``ports`` along a side of length ``w``, labels side by side about the middle."""
    at, found = (w - _row(ports)) / 2, {}
    for port in ports:
        size = widest([fitted(port, 28)], PORT)
        found[port] = at + size / 2
        at += size + GAP
    return found


def box_block(box: Box, edges: Iterable[Edge]) -> Block:
    """``box`` as a block, its ports in the order of the spec."""
    w, h = box_size(box)
    block = Block(w, h, frozenset([box.key]))
    place_ports(block, box, (box.ins, box.outs), edges)
    return block


def place_ports(
    block: Block, box: Box, order: tuple[Sequence[str], Sequence[str]], edges: Iterable[Edge]
) -> None:
    """Sets the ports of a single box in ``order`` from left to right, and the doors of its edges."""
    ins, outs = slots(order[0], block.w), slots(order[1], block.w)
    block.placed = [Placed(box, Rect(0, 0, block.w, block.h), tuple(ins.items()), tuple(outs.items()))]
    for edge in edges:
        if edge.target == box.key:
            block.top[edge] = ins[edge.into]
        if edge.source == box.key:
            block.bottom[edge] = outs[edge.out]
