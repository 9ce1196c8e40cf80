"""Binding: a spec becomes a graph. Names are looked up, ports joined, parameters made, rules checked."""

from __future__ import annotations

import re
from pathlib import Path

from visint.fields.kinds import KINDS
from visint.graph.callees import find_callee, plugins_named, stored_fields
from visint.graph.checks import RULES, loops_exist
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, MAP, Callee, Graph, Loop, Node, Until
from visint.graph.hub import expand
from visint.graph.parameters import make_params
from visint.graph.read import Places
from visint.graph.spec import GraphSpec, InputSpec, NodeSpec
from visint.graph.wiring import Wiring, edge_as_it_is
from visint.names import did_you_mean, is_name, listed
from visint.registry import Catalog

__all__ = ["bind"]


def bind(
    spec: GraphSpec,
    catalog: Catalog,
    places: Places | None = None,
    file: Path | None = None,
    calling: tuple[str, ...] = (),
) -> Graph:
    """The bound graph of ``spec``.

    Parameters
    ----------
    spec
        The graph as data.
    catalog
        Where names are looked up.
    places
        Where the spec's parts stand in its file, for messages.
    file
        The file it was read from.
    calling
        Names of the graphs being bound around this one, and its own: a graph that calls itself is refused.

    Raises
    ------
    GraphError
        VI2xx: all problems of naming and wiring together, else all broken rules together.
    PluginError
        Where a plugin that the graph uses is broken.
    """
    calling = calling or (spec.name,)
    draft = Draft(spec, catalog, places or Places(str(file or spec.name)), calling)
    _check_names(draft)
    _check_inputs(draft)
    draft.raise_problems()
    draft.fields = stored_fields(catalog, plugins_named(spec))
    _find_callees(draft)
    if spec.hub is not None:
        expand(draft)
        draft.raise_problems()
        _find_callees(draft)
    graph = _wire(draft, spec, file)
    draft.problems.extend(loops_exist(graph, draft))
    draft.raise_problems()  # the rules walk along loops and edges: these must be there
    draft.problems.extend(problem for rule in RULES for problem in rule(graph, draft))
    draft.raise_problems()
    return graph


def _check_names(draft: Draft) -> None:
    spec = draft.spec
    spokes = spec.hub.spokes if spec.hub else {}
    named: list[tuple[str, ...]] = [("name",)]
    for part in ("inputs", "loops", "nodes", "outputs"):
        named += [(part, name) for name in getattr(spec, part)]
    named += [("hub", "spokes", name) for name in spokes]
    for path in named:
        name = spec.name if path == ("name",) else path[-1]
        if not is_name(name):
            found = f"{name[:70]!r} is no name; a name is [a-z][a-z0-9_]*, at most 64 long"
            write = f"name: {_as_name(name)}" if path == ("name",) else f"{_as_name(name)}: …"
            draft.say("VI223", found, draft.where(*path, key=len(path) > 1), write=write)
    taken = {INPUTS: "the graph's inputs"} | ({MAP: "the hub's map"} if spec.hub else {})
    for name in spec.nodes:
        if name in taken or name in spokes:
            found = f"{name!r} is the name of {taken.get(name, 'a spoke')} already"
            draft.say("VI223", found, draft.where("nodes", name, key=True), write=f"{name}_2: …")
    for name in spokes:
        if name in taken:
            where = draft.where("hub", "spokes", name, key=True)
            draft.say("VI223", f"{name!r} is the name of {taken[name]} already", where, write=f"{name}_2: …")


def _as_name(text: str) -> str:
    """The name that is nearest to a text that is none."""
    plain = re.sub(r"[^a-z0-9_]+", "_", text.lower()).strip("_")[:64]
    return plain if is_name(plain) else f"n_{plain}"[:64].rstrip("_")


def _check_inputs(draft: Draft) -> None:
    for name, text in draft.spec.inputs.items():
        declared = InputSpec.parse(text)
        if draft.catalog.kind(declared.kind) is None:
            by_small = {kind.lower(): kind for kind in KINDS}
            near = by_small.get(did_you_mean(declared.kind.lower(), by_small) or "", "Image")
            choices = "kinds: " + listed(KINDS) + ", or plugin.Kind"
            write = f"{name}: {declared._replace(kind=near)}"
            found = f"there is no field kind {declared.kind[:70]!r}"
            draft.say("VI209", found, draft.where("inputs", name), choices, write)


def _find_callees(draft: Draft) -> None:
    for name, node in draft.spec.nodes.items():
        if name not in draft.callees:
            callee = find_callee(draft, node.uses, draft.where("nodes", name, "uses"))
            if callee is not None:
                draft.callees[name] = callee


def _wire(draft: Draft, spec: GraphSpec, file: Path | None) -> Graph:
    plain = draft.spec
    nodes = {
        name: _node(draft, name, node, draft.callees[name])
        for name, node in plain.nodes.items()
        if name in draft.callees
    }
    loops = {name: Loop(name, loop, _until(draft, name)) for name, loop in plain.loops.items()}
    outputs = {}
    for name, ref in plain.outputs.items():
        edge = edge_as_it_is(draft, ref, draft.where("outputs", name))
        if edge is not None:
            outputs[name] = edge
    inputs = {name: InputSpec.parse(text) for name, text in plain.inputs.items()}
    return Graph(spec, plain, inputs, loops, nodes, outputs, draft.catalog, file)


def _node(draft: Draft, name: str, node: NodeSpec, callee: Callee) -> Node:
    params = make_params(draft, node.with_, callee, ("nodes", name, "with"))
    at = {
        level: make_params(draft, {**node.with_, **over}, callee, ("nodes", name, "at", level))
        for level, over in node.at.items()
    }
    wiring = Wiring(draft, name, node, callee)
    ins, feedback = wiring.ins(), dict(wiring.feedbacks())
    wiring.check_fed()
    return Node(name, callee, params, at, ins, feedback, node.loop, node.levels, node.of)  # type: ignore[arg-type]


def _until(draft: Draft, name: str) -> Until | None:
    spec = draft.spec.loops[name].until
    if spec is None:
        return None
    path = ("loops", name, "until")
    change = spec.change_of and edge_as_it_is(draft, spec.change_of, draft.where(*path, "change_of"))
    holds = spec.holds and edge_as_it_is(draft, spec.holds, draft.where(*path, "holds"))
    return Until(spec, change or None, holds or None)
