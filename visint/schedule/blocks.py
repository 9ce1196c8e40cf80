"""Blocks: the nodes and loops that lie directly in a loop (or in none), in order."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import blake2b
from typing import Literal

import networkx as nx

from visint.graph.graph import Graph

__all__ = ["Blocks", "ItemName", "Spot"]

ItemName = tuple[Literal["node", "loop"], str]
Spot = tuple[str | None, ItemName]
"""A place in the schedule: the loop whose body it lies in, and the item there."""


class Blocks:
    """The bodies of all loops as ordered lists of items.

    Parameters
    ----------
    graph
        The bound graph.
    loops
        The loop each node runs in.
    ranks
        The rank of each node, which decides among items that wait for nothing.
    wires
        Nodes joined by their in-edges.
    """

    def __init__(
        self, graph: Graph, loops: Mapping[str, str | None], ranks: Mapping[str, int], wires: nx.DiGraph
    ) -> None:
        self._graph = graph
        self.loops = loops
        self._ranks = ranks
        self._digraphs = self._contracted(wires)
        self._items = {loop: self._sorted(digraph) for loop, digraph in self._digraphs.items()}
        self._index = {loop: {item: i for i, item in enumerate(items)} for loop, items in self._items.items()}

    def _contracted(self, wires: nx.DiGraph) -> dict[str | None, nx.DiGraph]:
        """One graph a block, in which each loop inside it is a single item."""
        digraphs: dict[str | None, nx.DiGraph] = {None: nx.DiGraph()}
        for name, loop in self.loops.items():
            outer: str | None = None
            for inner in self.chain(loop):
                digraphs.setdefault(outer, nx.DiGraph()).add_node(("loop", inner))
                outer = inner
            digraphs.setdefault(loop, nx.DiGraph()).add_node(("node", name))
        for source, target in wires.edges:
            block = self.common([self.loops[source], self.loops[target]])
            before = self.item_in(block, (self.loops[source], ("node", source)))
            after = self.item_in(block, (self.loops[target], ("node", target)))
            digraphs[block].add_edge(before, after)
        return digraphs

    def _sorted(self, digraph: nx.DiGraph) -> list[ItemName]:
        return list(nx.lexicographical_topological_sort(digraph, key=lambda item: (self._rank(item), item)))

    def _rank(self, item: ItemName) -> int:
        what, name = item
        if what == "node":
            return self._ranks[name]
        inner = sorted(self._ranks[node] for node, loop in self.loops.items() if name in self.chain(loop))
        return int.from_bytes(blake2b(repr(inner).encode(), digest_size=8).digest(), "big")

    def chain(self, loop: str | None) -> tuple[str, ...]:
        """The loops from the outermost to ``loop``."""
        return self._graph.loops_around(loop)

    def common(self, loops: list[str | None]) -> str | None:
        """The innermost block that holds all of ``loops``."""
        chains = [self.chain(loop) for loop in loops]
        shared: str | None = None
        for level in zip(*chains, strict=False):
            if len(set(level)) > 1:
                break
            shared = level[0]
        return shared

    def item_in(self, block: str | None, spot: Spot) -> ItemName:
        """The item of ``block`` that is, or holds, ``spot``."""
        loop, item = spot
        if loop == block:
            return item
        chain = self.chain(loop)
        return ("loop", chain[0 if block is None else chain.index(block) + 1])

    def items(self, loop: str | None) -> list[ItemName]:
        """The items of a block in order."""
        return self._items[loop]

    def position(self, block: str | None, spot: Spot) -> int:
        """The index in ``block`` of the item that is, or holds, ``spot``."""
        return self._index[block][self.item_in(block, spot)]

    def waits(self, loop: str | None) -> tuple[tuple[int, ...], ...]:
        """For each item of a block the indices of the items it waits for."""
        digraph, index = self._digraphs[loop], self._index[loop]
        return tuple(
            tuple(sorted(index[before] for before in digraph.predecessors(item))) for item in self._items[loop]
        )
