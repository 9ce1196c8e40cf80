"""Layout: which slot each value lies in, who reads it, and after whom it is let go."""

from __future__ import annotations

from collections import defaultdict

from visint.graph.callees import BEGIN, COMMIT
from visint.graph.graph import INPUTS, Edge, Feedback, Graph, Reader
from visint.names import PortRef
from visint.schedule.blocks import Blocks, Spot
from visint.schedule.steps import Cell, Fit, Out, Start

__all__ = ["Layout"]


class Layout:
    """Slots, cells and fits of a graph, filled node by node in topological order.

    Attributes
    ----------
    count
        Number of slots.
    slots
        Slot of each source, by how it is read.
    ins
        (port, slot or slots) of each node.
    cells, fits
        Feedback edges; values fitted to the levels of a pyramid.
    outputs, maps, kept, until
        Slots of the graph's outputs, of the map they were read from, of the spokes' evidence, and of the
        loops' end conditions.
    """

    def __init__(self, graph: Graph, blocks: Blocks) -> None:
        self.graph = graph
        self.count = 0
        self.slots: dict[tuple[PortRef, Reader], int] = {}
        self.ins: dict[str, list[tuple[str, int | tuple[int, ...]]]] = defaultdict(list)
        self.cells: list[Cell] = []
        self.fits: dict[tuple[int, str], Fit] = {}
        self.outputs: dict[str, int] = {}
        self.kept: dict[tuple[str, str], int] = {}
        self.maps: dict[str, int] = {}
        self.until: dict[str, tuple[int | None, int | None]] = {}
        self._blocks = blocks
        self._outs: dict[str, list[Out]] = defaultdict(list)
        self._homes: dict[int, Spot | None] = {}
        self._readers: dict[int, list[Spot]] = defaultdict(list)
        self._for_good: set[int] = set()

    def add_node(self, name: str) -> None:
        """Lays out what a node reads."""
        node = self.graph.nodes[name]
        loop = self._blocks.loops[name]
        spot: Spot = (loop, ("node", name))
        for port, edges in node.ins.items():
            if isinstance(edges, Edge):
                self.ins[name].append((port, self._read(edges, loop, spot)))
            else:
                self.ins[name].append((port, tuple(self._read(edge, loop, spot) for edge in edges)))
        for port, feedback in node.feedback.items():
            self.ins[name].append((port, self._cell(name, port, feedback, spot)))

    def add_ends(self) -> None:
        """Lays out what is read at the end: by loops that look whether to stop, and by the result."""
        for loop in self.graph.loops.values():
            if loop.until is not None and loop.name in self._looped():
                edges = (loop.until.change_of, loop.until.holds)
                change, holds = (edge and self._at_end_of(loop.name, edge) for edge in edges)
                self.until[loop.name] = (change, holds)
        for name, edge in self.graph.outputs.items():
            self.outputs[name] = self._forever(edge.source)
            node = self.graph.nodes.get(edge.source.node)
            if node is not None and node.callee.id in (BEGIN, COMMIT):
                self.maps[name] = self._forever(PortRef(node.name, "map"))
        for name, node in self.graph.nodes.items():
            for port, spec in node.callee.outputs.items():
                if spec.evidence and node.of == name:
                    self.kept[name, port] = self._forever(PortRef(name, port))

    def outs(self, name: str) -> tuple[Out, ...]:
        """The slots a node fills."""
        return tuple(self._outs.get(name, ()))

    def frees(self, loop: str | None) -> tuple[tuple[int, ...], ...]:
        """For each item of a block the slots that have had their last reader after it."""
        after: dict[int, list[int]] = defaultdict(list)
        for slot in range(self.count):
            place = self._last(slot)
            if place is not None and place[0] == loop:
                after[place[1]].append(slot)
        return tuple(tuple(after[i]) for i in range(len(self._blocks.items(loop))))

    def _last(self, slot: int) -> tuple[str | None, int] | None:
        """(block, index) of the item after which a slot is let go; None if never."""
        if slot in self._for_good:
            return None
        home = self._homes[slot]
        spots = [*self._readers[slot], *([home] if home else [])]
        block = self._blocks.common([*(loop for loop, _ in spots), home[0] if home else None])
        return block, max(self._blocks.position(block, spot) for spot in spots)

    def _new(self, home: Spot | None) -> int:
        self._homes[self.count] = home
        self.count += 1
        return self.count - 1

    def _slot(self, source: PortRef, reader: Reader) -> int:
        if (source, reader) not in self.slots:
            home: Spot | None = None
            if source.node != INPUTS:
                home = (self._blocks.loops[source.node], ("node", source.node))
            self.slots[source, reader] = self._new(home)
            self._outs[source.node].append(Out(self.slots[source, reader], source.port, reader))
        return self.slots[source, reader]

    def _read(self, edge: Edge, loop: str | None, spot: Spot) -> int:
        """The slot read for an edge inside ``loop``, until ``spot``."""
        slot = self._slot(edge.source, edge.reader)
        source_loop = None if edge.source.node == INPUTS else self._blocks.loops[edge.source.node]
        slot = self._fitted(slot, edge, loop, source_loop)
        self._readers[slot].append(spot)
        return slot

    def _fitted(self, slot: int, edge: Edge, loop: str | None, source_loop: str | None) -> int:
        """``slot`` itself, or one fitted to the level if ``loop`` lies in a pyramid and the source does not."""
        pyramid = self.graph.pyramid_around(loop)
        if pyramid is None or pyramid in self.graph.loops_around(source_loop):
            return slot
        at_pyramid = self._loop_spot(pyramid)
        if (slot, pyramid) not in self.fits:
            self.fits[slot, pyramid] = Fit(slot, self._new(at_pyramid), edge.kind)
            self._readers[slot].append(at_pyramid)
        return self.fits[slot, pyramid].slot

    def _loop_spot(self, loop: str) -> Spot:
        return self.graph.loops[loop].spec.inside, ("loop", loop)

    def _at_end_of(self, loop: str, edge: Edge) -> int:
        slot = self._slot(edge.source, edge.reader)
        self._readers[slot].append(self._loop_spot(loop))
        return slot

    def _forever(self, source: PortRef) -> int:
        slot = self._slot(source, "plain")
        self._for_good.add(slot)
        return slot

    def _cell(self, name: str, port: str, feedback: Feedback, spot: Spot) -> int:
        outermost = self.graph.loops_around(feedback.loop)[0]
        cell = self._new(self._loop_spot(outermost))
        source = self._at_end_of(feedback.loop, feedback.edge)
        start: float | str | Start | None
        if isinstance(feedback.start, Edge):
            begins = self._loop_spot(feedback.restart or feedback.loop)
            start = Start(self._read(feedback.start, feedback.loop, begins))
        else:
            start = feedback.start
        spec = self.graph.nodes[name].callee.inputs[port]
        giver = self.graph.nodes.get(feedback.edge.source.node)
        levels = giver.levels if giver else None
        self.cells.append(
            Cell(cell, source, feedback.loop, spec, feedback.edge.kind, start, feedback.restart, levels)
        )
        return self._fitted(cell, feedback.edge, spot[0], feedback.loop)

    def _looped(self) -> set[str]:
        return {loop for inner in self._blocks.loops.values() for loop in self.graph.loops_around(inner)}
