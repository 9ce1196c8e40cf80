"""Compiling a bound graph: blocks in topological order, slots for values, and their last readers."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import networkx as nx

from visint.graph.graph import INPUTS, Graph
from visint.schedule.blocks import Blocks
from visint.schedule.layout import Layout
from visint.schedule.order import effective_loops, ranks, structural_keys, waits, wires
from visint.schedule.steps import Block, Item, Pyramid, Repeat, Schedule, Step

__all__ = ["compile_graph"]


class _Same:
    """A graph as a key: the very object, for equal specs may have been bound to other modules."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph

    def __hash__(self) -> int:
        return id(self.graph)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.graph is self.graph


def compile_graph(graph: Graph) -> Schedule:
    """The schedule of ``graph``; it depends on the graph alone, and the last few are kept. Runs nothing."""
    return _compile(_Same(graph))


@lru_cache(maxsize=32)
def _compile(same: _Same) -> Schedule:
    graph = same.graph
    joined = wires(graph)
    order = list(nx.topological_sort(joined))
    keys = structural_keys(graph, order)
    loops = effective_loops(graph, order)
    blocks = Blocks(graph, loops, ranks(graph, order, keys), waits(graph, joined, loops))
    layout = Layout(graph, blocks)
    for name in order:
        layout.add_node(name)
    layout.add_ends()
    return Schedule(
        graph,
        layout.count,
        tuple((ref.port, reader, slot) for (ref, reader), slot in layout.slots.items() if ref.node == INPUTS),
        _block(layout, blocks, None, keys),
        layout.outputs,
        layout.kept,
        layout.maps,
        {loop: tuple(cell.slot for cell in layout.cells if cell.restart == loop) for loop in graph.loops},
    )


def _block(layout: Layout, blocks: Blocks, loop: str | None, keys: Mapping[str, int]) -> Block:
    items: list[Item] = []
    for what, name in blocks.items(loop):
        if what == "loop":
            items.append(_loop(layout, name, _block(layout, blocks, name, keys)))
        else:
            node = layout.graph.nodes[name]
            items.append(Step(node, tuple(layout.ins[name]), layout.outs(name), keys[name]))
    return Block(tuple(items), layout.frees(loop), blocks.waits(loop))


def _loop(layout: Layout, name: str, body: Block) -> Item:
    loop = layout.graph.loops[name]
    cells = tuple(cell for cell in layout.cells if cell.loop == name)
    if not loop.pyramid:
        return Repeat(loop, body, cells, *layout.until.get(name, (None, None)))
    carried = tuple(cell for cell in layout.cells if name in layout.graph.loops_around(cell.loop))
    fits = tuple(fit for (_, pyramid), fit in layout.fits.items() if pyramid == name)
    return Pyramid(loop, body, cells, fits, carried)
