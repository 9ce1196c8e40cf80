"""The rules that loops must keep, one function a rule. Each yields a problem for every place that breaks it."""

from __future__ import annotations

from collections.abc import Iterator

import networkx as nx

from visint.errors import Problem
from visint.fields.kinds import KINDS
from visint.graph.draft import Draft
from visint.graph.graph import MAP, Edge, Graph
from visint.module import PortSpec
from visint.names import did_you_mean, is_name, listed

__all__ = ["LOOP_RULES", "loops_exist"]

Found = Iterator[Problem]


def loops_exist(graph: Graph, draft: Draft) -> Found:
    """Every loop that is named is declared, and loops lie inside each other without a circle."""
    named: list[tuple[tuple[str, ...], str | None]]
    own = [(name, node) for name, node in graph.nodes.items() if name not in draft.origins]
    named = [(("nodes", name, "loop"), node.loop) for name, node in own]
    named += [(("loops", name, "inside"), loop.spec.inside) for name, loop in graph.loops.items()]
    if graph.spec.hub:
        named.append((("hub", "loop"), graph.spec.hub.loop))
    for path, loop in named:
        if loop is not None and loop not in graph.loops:
            where, choices = draft.where(*path), "loops: " + listed(graph.loops)
            near = did_you_mean(loop, graph.loops)
            write = (
                f"{path[-1]}: {near}"
                if near
                else f"loops: {{{loop if is_name(loop) else 'sweeps'}: {{times: 20}}}}"
            )
            yield Problem("VI208", f"there is no loop {loop[:70]!r}", where, choices, write)
    inside = nx.DiGraph(
        (name, loop.spec.inside) for name, loop in graph.loops.items() if loop.spec.inside is not None
    )
    for circle in nx.simple_cycles(inside):
        first = circle.index(min(circle, key=list(graph.loops).index))
        turned = [*circle[first:], *circle[:first]]
        found = "loops lie inside each other in a circle: " + " in ".join([*turned, turned[0]])
        write = f"{turned[0]}: {{…}}   (without 'inside')"
        yield Problem("VI208", found, draft.where("loops", turned[0], "inside"), write=write)


def loops_are_bounded(graph: Graph, draft: Draft) -> Found:
    """A turn loop has ``times``; a pyramid has ``coarsest`` or ``levels``; neither has the other's."""
    for name, loop in graph.loops.items():
        spec, where = loop.spec, draft.where("loops", name, key=True)
        if loop.pyramid and (spec.coarsest is None) == (spec.levels is None):
            has = "neither" if spec.levels is None else "both"
            found = f"the pyramid {name!r} wants one of 'coarsest' and 'levels', and has {has}"
            yield Problem("VI210", found, where, write="coarsest: 8")
        if not loop.pyramid and spec.times is None:
            choices = "a bound: times: 20 for turns, or over: pyramid with coarsest: 8 for levels"
            yield Problem("VI210", f"the loop {name!r} has no bound", where, choices, "times: 20")
        for key in ("times", "until") if loop.pyramid else ("coarsest", "levels", "between"):
            if getattr(spec, key):
                found = f"a pyramid has no {key!r}" if loop.pyramid else f"only a pyramid has {key!r}"
                write = f"sweeps: {{inside: {name}, times: 20}}" if loop.pyramid else "over: pyramid"
                yield Problem("VI210", found, draft.where("loops", name, key, key=True), write=write)


def between_names_kinds(graph: Graph, draft: Draft) -> Found:
    """``between`` says how to go up for kinds of pixels that may be interpolated."""
    able = [name for name, kind in KINDS.items() if kind.interpolated]
    for name, loop in graph.loops.items():
        for kind, how in loop.spec.between.items():
            found = draft.catalog.kind(kind)
            if found is None or not found.interpolated:
                near = did_you_mean(kind, able) or "Depth"
                said = f"there is no field kind {kind!r}" if found is None else f"{kind} is never interpolated"
                where = draft.where("loops", name, "between", kind, key=True)
                choices = "kinds that are: " + listed(able) + ", or plugin.Kind"
                yield Problem("VI209", said, where, choices, f"between: {{{near}: {how}}}")


def no_pyramid_in_a_pyramid(graph: Graph, draft: Draft) -> Found:
    """Levels are levels of the whole run: a pyramid lies in no other pyramid."""
    for name, loop in graph.loops.items():
        outer = graph.pyramid_around(loop.spec.inside)
        if loop.pyramid and outer is not None:
            found = f"the pyramid {name!r} lies inside the pyramid {outer!r}"
            write = f"{name}: {{inside: {loop.spec.inside}, times: 20}}"
            yield Problem("VI217", found, draft.where("loops", name, "inside"), write=write)
    for name, node in graph.nodes.items():
        outer, inner = graph.pyramid_around(node.loop), _pyramid_of(node.callee.graph)
        if outer is not None and inner is not None:
            found = f"{node.callee.id} has a pyramid of its own, {inner!r}, and is called inside {outer!r}"
            write = "(no 'loop', or one outside the pyramid)"
            yield Problem("VI217", found, draft.where("nodes", name, "loop"), write=write)


def _pyramid_of(graph: Graph | None) -> str | None:
    """The first pyramid in a sub-graph, those that it calls included."""
    if graph is None:
        return None
    own = (name for name, loop in graph.loops.items() if loop.pyramid)
    called = (_pyramid_of(node.callee.graph) for node in graph.nodes.values())
    return next((one for one in (*own, *called) if one is not None), None)


def ends_are_sound(graph: Graph, draft: Draft) -> Found:
    """``until`` names ``change_of`` with ``below``, or ``holds`` with a flag, of a node inside the loop."""
    for name, loop in graph.loops.items():
        if loop.until is None:
            continue
        spec, where = loop.until.spec, draft.where("loops", name, "until", key=True)
        change, flag = _ends(graph, name, "change_of"), _ends(graph, name, "holds")
        example = f"until: {{change_of: {next(iter(change), 'node.port')}, below: 1.0e-3}}"
        if (spec.change_of is None) == (spec.holds is None):
            has = "neither" if spec.holds is None else "both"
            found = f"'until' wants one of 'change_of' and 'holds', and has {has}"
            yield Problem("VI216", found, where, write=example)
        elif (spec.change_of is None) != (spec.below is None):
            write = "until: {holds: " + spec.holds + "}" if spec.holds else "below: 1.0e-3"
            yield Problem("VI216", "'change_of' and 'below' go together", where, write=write)
        yield from _unsound(graph, draft, ("loops", name, "until", "change_of"), loop.until.change_of, change)
        yield from _unsound(graph, draft, ("loops", name, "until", "holds"), loop.until.holds, flag)


def _ends(graph: Graph, loop: str, key: str) -> list[str]:
    """The ports that may end ``loop``: those in it that hold numbers, or a flag."""
    return [
        f"{name}.{port}"
        for name, node in graph.nodes.items()
        if loop in graph.loops_around(node.loop) and (node.callee.module or node.callee.graph or name == MAP)
        for port, spec in node.callee.outputs.items()
        if (_is_flag(spec) if key == "holds" else _is_number(spec))
    ]


def _is_flag(port: PortSpec) -> bool:
    return port.kind in ("Flag", "Scalar") and not port.many


def _is_number(port: PortSpec) -> bool:
    return (port.array is not None or port.kind in ("Scalar", "Flag")) and not port.many


def _unsound(graph: Graph, draft: Draft, path: tuple[str, ...], edge: Edge | None, ends: list[str]) -> Found:
    if edge is None or str(edge.source) in ends:
        return
    node = graph.nodes.get(edge.source.node)
    found = f"{edge.source} does not change inside the loop {path[1]!r}"
    if node is not None and path[1] in graph.loops_around(node.loop):
        wanted = "a Flag" if path[-1] == "holds" else "numbers"
        found = f"{edge.source} is {node.callee.outputs[edge.source.port]}; {path[-1]!r} wants {wanted}"
    same_node = [end for end in ends if end.startswith(f"{edge.source.node}.")]
    near = next(iter([*same_node, *ends]), "node.port")
    yield Problem("VI216", found, draft.where(*path), "what fits: " + listed(ends), f"{path[-1]}: {near}")


def restarts_are_outer_loops(graph: Graph, draft: Draft) -> Found:
    """``restart`` names a loop around the one that the feedback edge goes round in."""
    for name, node in graph.nodes.items():
        for port, feedback in node.feedback.items():
            outer = graph.loops_around(feedback.loop)[:-1]
            if feedback.restart is not None and feedback.restart not in outer:
                found = (
                    f"{feedback.restart[:70]!r} is not around {feedback.loop!r}, where this value goes round"
                )
                where = draft.where("nodes", name, "feedback", port, "restart")
                write = f"restart: {outer[-1]}" if outer else f"{port}: {{…}}   (without 'restart')"
                yield Problem("VI208", found, where, "loops around it: " + listed(outer), write)


def levels_lie_in_a_pyramid(graph: Graph, draft: Draft) -> Found:
    """``levels`` and ``at`` are for nodes in a pyramid, and within its levels where their number is given."""
    for name, node in graph.nodes.items():
        pyramid = graph.pyramid_around(node.loop)
        count = (graph.loops[pyramid].spec.levels or 64) if pyramid else 0
        for key, asked in (("levels", node.levels), ("at", node.at)):
            wrong = [level for level in asked or () if not 0 <= level < count]
            where = draft.where("nodes", name, key, key=True)
            if wrong and pyramid is None:
                outer = next((one for one, loop in graph.loops.items() if loop.pyramid), None)
                write = f"loop: {outer}" if outer else "loops: {levels: {over: pyramid, coarsest: 8}}"
                yield Problem("VI217", f"{name!r} asks for levels, but lies in no pyramid", where, write=write)
            elif wrong:
                found = f"{name!r} asks for level {wrong[0]}, which {pyramid!r} does not have"
                right = [level for level in asked or () if level not in wrong] or [0]
                write = f"levels: {right}" if key == "levels" else f"at: {{{right[0]}: {{…}}}}"
                yield Problem("VI217", found, where, f"levels: 0 to {count - 1}", write)


LOOP_RULES = (
    loops_are_bounded,
    between_names_kinds,
    no_pyramid_in_a_pyramid,
    ends_are_sound,
    restarts_are_outer_loops,
    levels_lie_in_a_pyramid,
)
"""Every rule on loops but :func:`loops_exist`, which comes before all others."""
