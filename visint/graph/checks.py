"""The rules a graph must keep, one function a rule. Each yields a problem for every place that breaks it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import networkx as nx

from visint.errors import Problem
from visint.graph.callees import BEGIN, COMMIT
from visint.graph.complaints import shown
from visint.graph.control_checks import controls_set_parameters
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, Edge, Graph, Node
from visint.graph.loop_checks import LOOP_RULES, loops_exist
from visint.graph.write import as_written
from visint.module import PortSpec
from visint.names import did_you_mean, listed

__all__ = ["RULES", "loops_exist"]

Found = Iterator[Problem]
Rule = Callable[[Graph, Draft], Found]
Wire = tuple[str, str]


def no_circle_without_feedback(graph: Graph, draft: Draft) -> Found:
    """The in-edges, and the edges that feedback starts from, form no circle."""
    wires = _wires(graph)
    rank = {name: i for i, name in enumerate(graph.nodes)}
    for component in nx.strongly_connected_components(wires):
        first = min(component, key=rank.__getitem__)
        if len(component) == 1 and not wires.has_edge(first, first):
            continue
        circle = [edge[0] for edge in nx.find_cycle(wires.subgraph(component), first)]
        last, target = circle[-1], circle[0]
        path, port, edge = next(one for one in _reads(graph.nodes[target]) if one[2].source.node == last)
        found = "nodes feed each other in a circle: " + " → ".join([*circle, target])
        start = "none" if graph.nodes[target].callee.inputs[port].optional else "0"
        loops = [{*graph.loops_around(graph.nodes[name].loop)} for name in circle]
        how = "instead of 'in'" + ("" if set.intersection(*loops) else "; and a loop around them")
        write = f"feedback: {{{port}: {{from: {edge.source}, start: {start}}}}}   (on {target!r}, {how})"
        if path[0] == "feedback":
            write = "start: none   (or a reference that does not depend on this node)"
        yield Problem("VI207", found, draft.where("nodes", target, *path), write=write)


def _reads(node: Node) -> Iterator[tuple[tuple[str, ...], str, Edge]]:
    """(path in the node, port, edge) of all that a node waits for before it first runs."""
    yield from ((("in", port), port, edge) for port, edge in node.edges())
    for port, feedback in node.feedback.items():
        if isinstance(feedback.start, Edge):
            yield ("feedback", port, "start"), port, feedback.start


def _wires(graph: Graph) -> nx.DiGraph:
    wires = nx.DiGraph()
    wires.add_nodes_from(graph.nodes)
    for name, node in graph.nodes.items():
        wires.add_edges_from((e.source.node, name) for _, _, e in _reads(node) if e.source.node != INPUTS)
    return wires


def no_path_leaves_a_loop_and_returns(graph: Graph, draft: Draft) -> Found:
    """A loop is one step of what is around it: no path of in-edges leaves it and comes back in one turn."""
    wires = _wires(graph)
    if not nx.is_directed_acyclic_graph(wires):
        return
    chains = {name: graph.loops_around(node.loop) for name, node in graph.nodes.items()}
    for block in (None, *graph.loops):
        inner = [name for name, chain in chains.items() if block is None or block in chain]
        depth = 0 if block is None else len(graph.loops_around(block))
        items = {name: (chains[name][depth : depth + 1] or (name, "")) for name in inner}
        steps = nx.DiGraph()
        for source, target in wires.subgraph(inner).edges:
            if items[source] != items[target]:
                steps.add_edge(items[source], items[target], wire=(source, target))
        for component in nx.strongly_connected_components(steps):
            if len(component) > 1:
                circle = nx.find_cycle(steps.subgraph(component), min(component))
                yield _leaving(graph, draft, [steps.edges[a, b]["wire"] for a, b in circle])


def _leaving(graph: Graph, draft: Draft, circle: Sequence[Wire]) -> Problem:
    """The problem of a circle of loops and nodes, each of whose ``circle`` of wires leads to the next."""
    leaving = next(i for i, (source, target) in enumerate(circle) if _leaves(graph, source, target))
    turned = [*circle[leaving:], *circle[:leaving]]
    source, outside = turned[0]
    loop = next(one for one in graph.loops_around(graph.nodes[source].loop) if _is_left(graph, one, outside))
    chained = all(before[1] == after[0] for before, after in pairwise(turned))
    said = " → ".join([source, *(wire[1] for wire in turned)])
    if not chained:
        said = ", ".join(f"{before} feeds {after}" for before, after in turned)
    found = f"a path leaves the loop {loop!r} and comes back: {said}"
    write = f"loop: {graph.nodes[source].loop}   (on {outside!r})"
    return Problem("VI211", found, draft.where("nodes", outside, key=True), write=write)


def _leaves(graph: Graph, source: str, target: str) -> bool:
    return any(_is_left(graph, loop, target) for loop in graph.loops_around(graph.nodes[source].loop))


def _is_left(graph: Graph, loop: str, target: str) -> bool:
    return loop not in graph.loops_around(graph.nodes[target].loop)


_NUMBERS = frozenset(
    {"Image", "Depth", "Disparity", "Relief", "Confidence", "Sigma", "Mask", "Boundaries", "Regions"}
)
_PLANES = ("Depth", "Disparity")
_SINGLE = frozenset({"Scalar", "Flag"})


def starts_fit(graph: Graph, draft: Draft) -> Found:
    """A start fits its port: a plane for depth or disparity, a number for what holds them."""
    choices = "starts: none, a number, plane, or node.port from outside the loop"
    for name, node in graph.nodes.items():
        for port, feedback in node.feedback.items():
            spec = node.callee.inputs[port]
            said = _start_fault(graph, spec, feedback.start, feedback.loop)
            if said:
                where = draft.where("nodes", name, "feedback", port, "start")
                yield Problem("VI215", said, where, choices, f"start: {_right_start(spec)}")


def _start_fault(graph: Graph, port: PortSpec, start: float | str | Edge | None, loop: str) -> str:
    if isinstance(start, Edge):
        source = graph.nodes.get(start.source.node)
        inside = source is not None and loop in graph.loops_around(source.loop)
        return f"the start {start.source} lies inside the loop {loop!r}" if inside else ""
    if start is None:
        return "" if port.optional else f"{port.name!r} must be fed, so its feedback wants a start"
    if start == "plane":
        fits = port.kind in _PLANES and not port.evidence
        return "" if fits else f"'plane' is a start for Depth or Disparity; {port.name!r} is {port}"
    fits = port.kind in _NUMBERS | _SINGLE and not port.evidence and not port.many
    return "" if fits else f"a number is no start for {port.name!r}, which is {port}"


def _right_start(port: PortSpec) -> str:
    if port.optional:
        return "none"
    if port.kind in _NUMBERS | _SINGLE and not port.evidence and not port.many:
        return "plane" if port.kind in _PLANES else "0"
    return f"node.port   (of a node outside the loop that gives {port})"


def the_map_starts_with_its_fields(graph: Graph, draft: Draft) -> Found:
    """``start`` of a hub names fields that the map stores, each with a start that it can have."""
    for name, node in graph.nodes.items():
        for field, start in dict(node.params).items() if node.callee.id == BEGIN else ():
            kind = draft.fields.get(field)
            where = draft.where("nodes", name, "with", field, key=kind is None)
            if kind is None:
                near = did_you_mean(field, draft.fields) or "depth"
                found, known = f"the map stores no field {field!r}", "fields: " + listed(draft.fields)
                yield Problem("VI215", found, where, known, f"{near}: {as_written(start)}")
            elif start == "plane" and kind.name not in _PLANES:
                found = f"'plane' is a start for Depth or Disparity; {field!r} is {kind.name}"
                yield Problem("VI215", found, where, "starts: none, a number, or node.port", f"{field}: none")
            elif not (start in ("none", "plane") or isinstance(start, int | float)):
                found = f"{shown(start)} is no start for {field!r}"
                right = "plane" if kind.name in _PLANES else "none"
                yield Problem(
                    "VI215", found, where, "starts: none, a number, plane, node.port", f"{field}: {right}"
                )


def limited_nodes_feed_optional_ports(graph: Graph, draft: Draft) -> Found:
    """Where a node does not run its outputs are None: only optional ports, and lists, may take them."""
    for name, node in graph.nodes.items():
        read = [("in", port, edge) for port, edge in node.edges()]
        read += [("feedback", port, feedback.edge) for port, feedback in node.feedback.items()]
        for key, port, edge in read:
            source = graph.nodes.get(edge.source.node)
            spec = node.callee.inputs[port]
            if source is None or source.levels is None or spec.optional or spec.many:
                continue
            if not _runs_less(node, source, graph):
                levels = f"[{listed(map(str, source.levels), none='')}]"
                found = f"{source.name!r} runs at levels {levels} only, and {port!r} must always be fed"
                write = f"levels: {levels}   (on {name!r})"
                if graph.pyramid_around(node.loop) != graph.pyramid_around(source.loop):
                    levels = f"[{listed(map(str, sorted({0, *source.levels})), none='')}]"
                    write = f"levels: {levels}   (on {source.name!r}: from outside one sees level 0)"
                yield Problem("VI213", found, draft.where("nodes", name, key, port), write=write)


def _runs_less(node: Node, source: Node, graph: Graph) -> bool:
    """Whether ``node`` runs only where ``source`` does, or sees its last level, from outside the pyramid."""
    if graph.pyramid_around(node.loop) != graph.pyramid_around(source.loop):
        return 0 in (source.levels or ())
    return node.levels is not None and set(node.levels) <= set(source.levels or ())


def writers_of_the_map_stand_in_order(graph: Graph, draft: Draft) -> Found:
    """Each state of the map is committed to once; two commits to one state would be in no order."""
    writers: dict[object, str] = {}
    for name, node in graph.nodes.items():
        edge = node.ins.get("map")
        if node.callee.id != COMMIT or not isinstance(edge, Edge):
            continue
        first = writers.setdefault(edge.source, name)
        if first != name:
            found = f"{first!r} and {name!r} both commit to {edge.source}, in no order"
            where = draft.where("nodes", name, "in", "map")
            yield Problem("VI212", found, where, write=f"map: {first}.map")


RULES: tuple[Rule, ...] = (
    *LOOP_RULES,
    no_circle_without_feedback,
    no_path_leaves_a_loop_and_returns,
    starts_fit,
    the_map_starts_with_its_fields,
    limited_nodes_feed_optional_ports,
    writers_of_the_map_stand_in_order,
    controls_set_parameters,
)
"""Every rule but :func:`loops_exist`, which comes first; the problems are told in the order of the file."""
