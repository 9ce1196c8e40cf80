"""The order of nodes: by the graph alone, not by key order, names or hashing."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import blake2b
from typing import Any, NamedTuple

import networkx as nx
from pydantic import BaseModel

from visint.graph.graph import INPUTS, Edge, Feedback, Graph, Node
from visint.graph.spec import LoopSpec

__all__ = ["effective_loops", "ranks", "structural_keys", "waits", "wires"]


def wires(graph: Graph) -> nx.DiGraph:
    """Nodes joined by their in-edges, and by the edges that feedback starts from."""
    digraph = nx.DiGraph()
    digraph.add_nodes_from(graph.nodes)
    for name, node in graph.nodes.items():
        digraph.add_edges_from(
            (edge.source.node, name) for edge in _all_sources(node) if edge.source.node != INPUTS
        )
    return digraph


def _all_sources(node: Node) -> Iterable[Edge]:
    yield from (edge for _, edge in node.edges())
    yield from (f.start for f in node.feedback.values() if isinstance(f.start, Edge))


def structural_keys(graph: Graph, order: Iterable[str]) -> Mapping[str, int]:
    """A number for each node that follows from what it runs and what feeds it, never from its name.

    Two rounds over the nodes in a topological ``order``: the second knows what the feedback edges of the
    first come from. Nodes with equal keys do the same thing to the same values.
    """
    order = list(order)
    keys: dict[str, int] = {}
    for _ in range(2):
        known = dict(keys)
        for name in order:
            keys[name] = _key(graph, graph.nodes[name], keys, known)
    return keys


def _key(graph: Graph, node: Node, keys: Mapping[str, int], known: Mapping[str, int]) -> int:
    text = [
        node.callee.id,
        node.callee.version,
        _params(node.params),
        *(f"{level}{_params(params)}" for level, params in sorted(node.at.items())),
        repr(node.levels),
        *(_loop(graph.loops[loop].spec) for loop in graph.loops_around(node.loop)),
    ]
    for port, edges in sorted(node.ins.items()):
        sources = (edges,) if isinstance(edges, Edge) else edges
        text.extend(f"{port}<{_source(edge, keys)}" for edge in sources)
    for port, feedback in sorted(node.feedback.items()):
        text.append(f"{port}@{_fed_back(feedback, known, keys)}")
    return _hashed(text)


def ranks(graph: Graph, order: Sequence[str], keys: Mapping[str, int]) -> Mapping[str, int]:
    """A number for each node that also follows from what it feeds: what decides among nodes that may run now.

    Nodes with equal structural ``keys`` do the same, yet a loop may wait for one and not for the other; by
    keys alone their names would then decide when the loop runs.
    """
    readers: dict[str, list[_Reader]] = {name: [] for name in graph.nodes}
    for source, reader in _readers(graph):
        if source != INPUTS:
            readers[source].append(reader)
    seen = {name: f"{keys[name]} {_read_at_the_end(graph, name)}" for name in graph.nodes}
    found = dict(keys)
    for _ in range(2):
        known = dict(found)  # feedback is read a turn later: of its readers the round before counts
        for name in reversed(order):
            marks = [f"{one.how} {(known if one.later else found)[one.name]}" for one in readers[name]]
            found[name] = _hashed([seen[name], *sorted(marks)])
    return found


class _Reader(NamedTuple):
    """Who reads a node, through which ports, and whether only a turn later."""

    name: str
    how: str
    later: bool = False


def _readers(graph: Graph) -> Iterator[tuple[str, _Reader]]:
    for name, node in graph.nodes.items():
        for port, edge in node.edges():
            yield edge.source.node, _Reader(name, f"{edge.source.port}>{port}")
        for port, feedback in node.feedback.items():
            source = feedback.edge.source
            yield source.node, _Reader(name, f"{source.port}@{port}", later=True)
            if isinstance(feedback.start, Edge):
                yield feedback.start.source.node, _Reader(name, f"{feedback.start.source.port}^{port}")


def _read_at_the_end(graph: Graph, name: str) -> str:
    """The graph's outputs and the ends of loops that read ``name``."""
    ends = [
        f"{edge.source.port} {output}" for output, edge in graph.outputs.items() if edge.source.node == name
    ]
    for loop in graph.loops.values():
        watched = (loop.until.change_of, loop.until.holds) if loop.until else ()
        ends += [f"{edge.source.port} until" for edge in watched if edge and edge.source.node == name]
    return repr(sorted(ends))


def _hashed(text: Iterable[str]) -> int:
    return int.from_bytes(blake2b("\n".join(text).encode(), digest_size=8).digest(), "big")


def _loop(spec: LoopSpec) -> str:
    """A loop without the names in it: those of the loop around it and of what it watches."""
    nameless = spec.model_dump(exclude={"inside": True, "until": {"change_of": True, "holds": True}})
    return json.dumps(nameless, sort_keys=True)


def _params(params: Any) -> str:
    return params.model_dump_json() if isinstance(params, BaseModel) else repr(sorted(params.items()))


def _source(edge: Edge, keys: Mapping[str, int]) -> str:
    name = edge.source.node
    return f"{name if name == INPUTS else keys[name]}.{edge.source.port}"


def _fed_back(feedback: Feedback, known: Mapping[str, int], keys: Mapping[str, int]) -> str:
    start = _source(feedback.start, keys) if isinstance(feedback.start, Edge) else repr(feedback.start)
    source = feedback.edge.source
    origin = source.node if source.node == INPUTS else known.get(source.node, 0)
    return f"{origin}.{source.port} {start} {feedback.restart is not None}"


def effective_loops(graph: Graph, order: Iterable[str]) -> Mapping[str, str | None]:
    """The loop each node runs in: its own, or further out where a turn loop feeds it nothing.

    Never out of a pyramid, and never a node whose result may change from turn to turn by itself.
    """
    loops: dict[str, str | None] = {}
    for name in order:
        node = graph.nodes[name]
        loop = node.loop
        while loop is not None and not _held(graph, node, loop, loops):
            loop = graph.loops[loop].spec.inside
        loops[name] = loop
    return loops


def waits(graph: Graph, joined: nx.DiGraph, loops: Mapping[str, str | None]) -> nx.DiGraph:
    """``joined``, and what a loop waits for besides: nodes lifted out of it that it reads after each turn.

    Those are the sources of values that go round in it, and what its end condition looks at.
    """
    edges = [
        (feedback.edge.source.node, name, feedback.loop)
        for name, node in graph.nodes.items()
        for feedback in node.feedback.values()
    ]
    for loop in graph.loops.values():
        inner = next((name for name, one in loops.items() if loop.name in graph.loops_around(one)), None)
        watched = (loop.until.change_of, loop.until.holds) if loop.until and inner else ()
        edges += [(edge.source.node, inner, loop.name) for edge in watched if edge and inner]
    waiting = joined.copy()
    waiting.add_edges_from(
        (source, name) for source, name, loop in edges if loop not in graph.loops_around(loops[source])
    )
    return waiting


def _held(graph: Graph, node: Node, loop: str, loops: Mapping[str, str | None]) -> bool:
    """Whether ``node`` must run at every turn of ``loop``."""
    if graph.loops[loop].pyramid or per_turn(node):
        return True
    if any(feedback.loop == loop for feedback in node.feedback.values()):
        return True
    return any(
        edge.source.node != INPUTS and loop in graph.loops_around(loops[edge.source.node])
        for edge in _all_sources(node)
    )


def per_turn(node: Node) -> bool:
    """Whether a node may give another result for equal inputs: its module says so, or one of its sub-graph."""
    if node.callee.graph is not None:
        return any(per_turn(inner) for inner in node.callee.graph.nodes.values())
    return node.callee.module is not None and node.callee.module.per_turn
