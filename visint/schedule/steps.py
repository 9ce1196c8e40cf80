"""The schedule as plain data: steps, loops and levels over numbered slots.

Values lie in slots. A step reads some and fills others; a block says after which of its items a slot has
had its last reader and is let go. A cell is a slot that a feedback edge fills at the end of a turn.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from visint.fields.kinds import FieldKind
from visint.graph.graph import Graph, Loop, Node, Reader
from visint.module import PortSpec

__all__ = ["Block", "Cell", "Fit", "Item", "Out", "Pyramid", "Repeat", "Schedule", "Step"]

Slot = int


class Out(NamedTuple):
    """A slot that a step fills: with which of its ports, read how."""

    slot: Slot
    port: str
    reader: Reader


@dataclass(frozen=True, slots=True)
class Step:
    """One call of a node: the slots of its ports and outputs, and its place in the graph as a number."""

    node: Node
    ins: tuple[tuple[str, Slot | tuple[Slot, ...]], ...]
    outs: tuple[Out, ...]
    key: int


@dataclass(frozen=True, slots=True)
class Cell:
    """A feedback edge: ``slot`` gets what ``source`` holds at the end of each turn of ``loop``.

    ``start`` is None, a number, ``"plane"`` or the slot of a value; ``restart`` a loop at whose turns it
    starts anew. ``carry`` is the kind by whose rule the value goes from level to level. Where the source
    is limited to some ``levels``, the cell keeps what it has at the others.
    """

    slot: Slot
    source: Slot
    loop: str
    port: PortSpec
    carry: FieldKind
    start: float | str | Start | None = None
    restart: str | None = None
    levels: tuple[int, ...] | None = None


class Start(NamedTuple):
    """The slot that a cell starts from."""

    slot: Slot


class Fit(NamedTuple):
    """A value from outside a pyramid, fitted to the level into a slot of its own."""

    source: Slot
    slot: Slot
    kind: FieldKind


@dataclass(frozen=True, slots=True)
class Block:
    """Items in order; ``frees[i]`` are the slots let go after item i, ``after[i]`` the items it waits for."""

    items: tuple[Item, ...]
    frees: tuple[tuple[Slot, ...], ...]
    after: tuple[tuple[int, ...], ...]

    def steps(self) -> Iterator[Step]:
        """Every step of the block and of the loops in it, in order."""
        for item in self.items:
            if isinstance(item, Step):
                yield item
            else:
                yield from item.body.steps()


@dataclass(frozen=True, slots=True)
class Repeat:
    """A turn loop. ``change`` and ``holds`` are the slots its end condition looks at."""

    loop: Loop
    body: Block
    cells: tuple[Cell, ...]
    change: Slot | None = None
    holds: Slot | None = None


@dataclass(frozen=True, slots=True)
class Pyramid:
    """A loop over levels, coarsest first. ``carried`` are all cells that live through its levels."""

    loop: Loop
    body: Block
    cells: tuple[Cell, ...]
    fits: tuple[Fit, ...]
    carried: tuple[Cell, ...]


Item = Step | Repeat | Pyramid


@dataclass(frozen=True, slots=True, eq=False)
class Schedule:
    """A whole graph in order; what is made from it can be kept by it.

    Attributes
    ----------
    inputs
        (name, reader, slot) of each way a graph input is read.
    outputs
        Slot of each output; evidence is kept whole, with its sigma and reliability.
    kept
        Slots of the evidence of each spoke, by (spoke, port).
    maps
        Slot of the snapshot that an output was read from, by output.
    restarts
        The cells that start anew at each turn of a loop.
    """

    graph: Graph
    slots: int
    inputs: tuple[tuple[str, Reader, Slot], ...]
    root: Block
    outputs: Mapping[str, Slot]
    kept: Mapping[tuple[str, str], Slot]
    maps: Mapping[str, Slot]
    restarts: Mapping[str, tuple[Slot, ...]]
