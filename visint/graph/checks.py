"""The rules a graph must keep, one function a rule. Each yields a problem for every place that breaks it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import networkx as nx

from visint.errors import Problem
from visint.graph.callees import COMMIT
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, Edge, Graph, Node
from visint.module import PortSpec
from visint.names import did_you_mean, listed

__all__ = ["RULES", "loops_exist"]

Rule = Callable[[Graph, Draft], Iterator[Problem]]


def loops_exist(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """Every loop that is named is declared, and loops lie inside each other without a circle."""
    named: list[tuple[tuple[str, ...], str | None]] = [
        (("nodes", name, "loop"), node.loop) for name, node in graph.nodes.items()
    ]
    named += [(("loops", name, "inside"), loop.spec.inside) for name, loop in graph.loops.items()]
    if graph.spec.hub:
        named.append((("hub", "loop"), graph.spec.hub.loop))
    for path, loop in named:
        if loop is not None and loop not in graph.loops:
            near = did_you_mean(loop, graph.loops)
            write = f"{path[-1]}: {near}" if near else f"loops: {{{loop}: {{times: 10}}}}"
            choices = "loops: " + listed(graph.loops)
            yield Problem("VI208", f"there is no loop {loop!r}", draft.where(*path), choices, write)
    inside = nx.DiGraph(
        (name, loop.spec.inside) for name, loop in graph.loops.items() if loop.spec.inside is not None
    )
    for circle in nx.simple_cycles(inside):
        found = "loops lie inside each other in a circle: " + " in ".join([*circle, circle[0]])
        yield Problem("VI208", found, draft.where("loops", circle[0], "inside"))


def loops_are_bounded(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """A turn loop has ``times``; a pyramid has ``coarsest`` or ``levels``; neither has the other's."""
    for name, loop in graph.loops.items():
        spec, where = loop.spec, draft.where("loops", name)
        if loop.pyramid and (spec.coarsest is None) == (spec.levels is None):
            found = f"the pyramid {name!r} wants one of 'coarsest' and 'levels'"
            yield Problem("VI210", found, where, write="coarsest: 8")
        if not loop.pyramid and spec.times is None:
            yield Problem("VI210", f"the loop {name!r} has no bound", where, write="times: 20")
        wrong = ("times", "until") if loop.pyramid else ("coarsest", "levels", "between")
        for key in wrong:
            if getattr(spec, key):
                owner = "a pyramid has" if loop.pyramid else "only a pyramid ('over: pyramid') has"
                found = f"{owner} no {key!r}" if loop.pyramid else f"{owner} {key!r}"
                yield Problem("VI210", found, draft.where("loops", name, key, key=True))


def no_pyramid_in_a_pyramid(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """Levels are levels of the whole run: a pyramid lies in no other pyramid."""
    for name, loop in graph.loops.items():
        outer = graph.pyramid_around(loop.spec.inside)
        if loop.pyramid and outer is not None:
            found = f"the pyramid {name!r} lies inside the pyramid {outer!r}"
            yield Problem("VI217", found, draft.where("loops", name, "inside"))


def ends_are_sound(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """``until`` names ``change_of`` with ``below``, or ``holds`` with a flag, of a node inside the loop."""
    for name, loop in graph.loops.items():
        if loop.until is None:
            continue
        spec, path = loop.until.spec, ("loops", name, "until")
        if (spec.change_of is None) == (spec.holds is None):
            found = "'until' wants one of 'change_of' and 'holds'"
            yield Problem(
                "VI216", found, draft.where(*path), write="until: {change_of: node.port, below: 1.0e-3}"
            )
        if (spec.change_of is None) != (spec.below is None):
            yield Problem(
                "VI216", "'change_of' and 'below' go together", draft.where(*path), write="below: 1.0e-3"
            )
        for key, edge in (("change_of", loop.until.change_of), ("holds", loop.until.holds)):
            yield from _sound_end(graph, draft, name, key, edge)


def _sound_end(graph: Graph, draft: Draft, loop: str, key: str, edge: Edge | None) -> Iterator[Problem]:
    if edge is None:
        return
    where = draft.where("loops", loop, "until", key)
    node = graph.nodes.get(edge.source.node)
    if node is None or loop not in graph.loops_around(node.loop):
        inner = [name for name, one in graph.nodes.items() if loop in graph.loops_around(one.loop)]
        found = f"{edge.source} does not change inside the loop {loop!r}"
        yield Problem("VI216", found, where, "nodes inside: " + listed(inner))
    elif key == "holds" and edge.kind.name not in ("Flag", "Scalar"):
        yield Problem("VI216", f"{edge.source} is {edge.kind.name}; 'holds' wants a Flag", where)


def no_circle_without_feedback(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """The in-edges alone form no circle."""
    wires = _wires(graph)
    for component in nx.strongly_connected_components(wires):
        first = min(component, key=list(graph.nodes).index)
        if len(component) == 1 and not wires.has_edge(first, first):
            continue
        circle = [edge[0] for edge in nx.find_cycle(wires.subgraph(component), first)]
        last, target = circle[-1], circle[0]
        port, edge = next(pe for pe in graph.nodes[target].edges() if pe[1].source.node == last)
        found = "nodes feed each other in a circle: " + " → ".join([*circle, target])
        write = f"feedback: {{{port}: {{from: {edge.source}, start: none}}}}   (instead of 'in', on {target!r})"
        yield Problem("VI207", found, draft.where("nodes", target, "in", port), write=write)


def _wires(graph: Graph) -> nx.DiGraph:
    wires = nx.DiGraph()
    wires.add_nodes_from(graph.nodes)
    wires.add_edges_from(
        (edge.source.node, name)
        for name, node in graph.nodes.items()
        for _, edge in node.edges()
        if edge.source.node != INPUTS
    )
    return wires


def no_path_leaves_a_loop_and_returns(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """A loop is one step of what is around it: no path of in-edges leaves it and comes back in one turn."""
    wires = _wires(graph)
    if not nx.is_directed_acyclic_graph(wires):
        return
    for loop in graph.loops:
        inner = {name for name, node in graph.nodes.items() if loop in graph.loops_around(node.loop)}
        for leaving, outside in [(a, b) for a, b in wires.edges if a in inner and b not in inner]:
            after = {outside} | nx.descendants(wires, outside)
            returning = sorted(after & inner, key=list(graph.nodes).index)
            if returning:
                path = nx.shortest_path(wires, outside, returning[0])
                found = f"a path leaves the loop {loop!r} and comes back: " + " → ".join([leaving, *path])
                write = f"loop: {graph.nodes[leaving].loop}   (on {outside!r})"
                yield Problem("VI211", found, draft.where("nodes", outside), write=write)
                break


def restarts_are_outer_loops(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """``restart`` names a loop around the one that the feedback edge goes round in."""
    for name, node in graph.nodes.items():
        for port, feedback in node.feedback.items():
            outer = graph.loops_around(feedback.loop)[:-1]
            if feedback.restart is not None and feedback.restart not in outer:
                found = f"{feedback.restart!r} is no loop around {feedback.loop!r}, where this value goes round"
                where = draft.where("nodes", name, "feedback", port, "restart")
                yield Problem("VI208", found, where, "loops around it: " + listed(outer))


def starts_fit(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """A feedback edge's start fits its port: a plane for depth or disparity, a number for what holds them."""
    for name, node in graph.nodes.items():
        for port, feedback in node.feedback.items():
            said = _start_fault(graph, node.callee.inputs[port], feedback.start, feedback.loop)
            if said:
                path = ("nodes", name, "feedback", port)
                choices = "starts: none, a number, plane, or node.port from outside the loop"
                yield Problem("VI215", said, draft.where(*path), choices, "start: 0")


_NUMBERS = frozenset(
    {"Image", "Depth", "Disparity", "Relief", "Confidence", "Sigma", "Mask", "Boundaries", "Regions"}
)


def _start_fault(graph: Graph, port: PortSpec, start: float | str | Edge | None, loop: str) -> str:
    if isinstance(start, Edge):
        source = graph.nodes.get(start.source.node)
        inside = source is not None and loop in graph.loops_around(source.loop)
        return f"the start {start.source} lies inside the loop {loop!r}" if inside else ""
    if start is None:
        return "" if port.optional else f"{port.name!r} must be fed, so its feedback wants a start"
    if start == "plane":
        fits = port.kind in ("Depth", "Disparity") and not port.evidence
        return "" if fits else f"'plane' is a start for Depth or Disparity; {port.name!r} is {port}"
    fits = port.kind in _NUMBERS | {"Scalar", "Flag"} and not port.evidence
    return "" if fits else f"a number is no start for {port.name!r}, which is {port}"


def levels_lie_in_a_pyramid(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """``levels`` and ``at`` are for nodes in a pyramid, and within its levels where their number is given."""
    for name, node in graph.nodes.items():
        asked = [("levels", level) for level in node.levels or ()] + [("at", level) for level in node.at]
        pyramid = graph.pyramid_around(node.loop)
        count = graph.loops[pyramid].spec.levels if pyramid else None
        for key, level in asked:
            if pyramid is None or level < 0 or (count is not None and level >= count):
                found = "lies in no pyramid" if pyramid is None else f"{pyramid!r} has no level {level}"
                where = draft.where("nodes", name, key)
                yield Problem("VI217", f"{name!r} asks for level {level}, but {found}", where)
                break


def limited_nodes_feed_optional_ports(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """Where a node does not run its outputs are None: only optional ports, and lists, may take them."""
    for name, node in graph.nodes.items():
        for port, edge in [*node.edges(), *((p, f.edge) for p, f in node.feedback.items())]:
            source = graph.nodes.get(edge.source.node)
            if source is None or source.levels is None or _runs_less(node, source, graph):
                continue
            spec = node.callee.inputs[port]
            if not (spec.optional or spec.many):
                levels = f"[{listed(map(str, source.levels))}]"
                found = f"{source.name!r} runs at levels {levels} only; {port!r} must always be fed"
                key = "in" if port in node.ins else "feedback"
                yield Problem(
                    "VI213",
                    found,
                    draft.where("nodes", name, key, port),
                    write=f"levels: {levels}   (on {name!r})",
                )


def _runs_less(node: Node, source: Node, graph: Graph) -> bool:
    """Whether ``node`` runs only where ``source`` does, or sees its last level, from outside the pyramid."""
    if graph.pyramid_around(node.loop) != graph.pyramid_around(source.loop):
        return 0 in (source.levels or ())
    return node.levels is not None and set(node.levels) <= set(source.levels or ())


def writers_of_the_map_stand_in_order(graph: Graph, draft: Draft) -> Iterator[Problem]:
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


def controls_name_parameters(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """A control sets parameters that there are."""
    for control, settings in graph.spec.controls.items():
        for key in settings:
            name, _, param = key.partition(".")
            node = graph.nodes.get(name)
            where = draft.where("controls", control, key)
            if node is None:
                near = did_you_mean(name, graph.nodes)
                write = f"{near}.{param}" if near else ""
                yield Problem(
                    "VI219", f"there is no node {name!r}", where, "nodes: " + listed(graph.nodes), write
                )
            elif node.callee.module and param not in node.callee.module.Params.model_fields:
                known = node.callee.module.Params.model_fields
                found = f"{node.callee.id} has no parameter {param!r}"
                yield Problem("VI219", found, where, "parameters: " + listed(known))


RULES: tuple[Rule, ...] = (
    loops_are_bounded,
    no_pyramid_in_a_pyramid,
    ends_are_sound,
    no_circle_without_feedback,
    no_path_leaves_a_loop_and_returns,
    restarts_are_outer_loops,
    starts_fit,
    levels_lie_in_a_pyramid,
    limited_nodes_feed_optional_ports,
    writers_of_the_map_stand_in_order,
    controls_name_parameters,
)
"""Every rule but :func:`loops_exist`, which comes first; in the order in which a reader would meet them."""
