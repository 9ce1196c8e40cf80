"""Binding: a spec becomes a graph. Names are looked up, ports joined, parameters made, rules checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from visint.errors import Where
from visint.fields.kinds import KINDS, FieldKind
from visint.graph.callees import find_callee, plugins_named, stored_fields
from visint.graph.checks import RULES, loops_exist
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, MAP, Callee, Edge, Feedback, Graph, Loop, Node, Until
from visint.graph.hub import expand
from visint.graph.ports import reader_between
from visint.graph.read import Places
from visint.graph.spec import FeedbackSpec, GraphSpec, InputSpec, NodeSpec
from visint.module import Params, PortSpec
from visint.names import did_you_mean, is_name, listed
from visint.registry import Catalog

__all__ = ["bind"]

MAP_KIND = FieldKind("Map")


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
    draft.raise_problems()
    draft.problems.extend(loops_exist(graph, draft))  # the other rules walk along the loops
    draft.raise_problems()
    draft.problems.extend(problem for rule in RULES for problem in rule(graph, draft))
    draft.raise_problems()
    return graph


def _check_names(draft: Draft) -> None:
    spec = draft.spec
    named: list[tuple[str, ...]] = [("name",)]
    named += [("inputs", name) for name in spec.inputs] + [("loops", name) for name in spec.loops]
    named += [("nodes", name) for name in spec.nodes] + [("outputs", name) for name in spec.outputs]
    named += [("hub", "spokes", name) for name in (spec.hub.spokes if spec.hub else ())]
    for path in named:
        name = spec.name if path == ("name",) else str(path[-1])
        if not is_name(name):
            found = f"{name!r} is no name; a name is [a-z][a-z0-9_]*, at most 64 long"
            draft.say("VI223", found, draft.where(*path, key=len(path) > 1))
    taken = {INPUTS: "the graph's inputs"} | ({MAP: "the hub's map"} if spec.hub else {})
    spokes = spec.hub.spokes if spec.hub else {}
    for name in spec.nodes:
        if name in taken or name in spokes:
            found = f"{name!r} is the name of {taken.get(name, 'a spoke')} already"
            draft.say("VI223", found, draft.where("nodes", name, key=True))


def _check_inputs(draft: Draft) -> None:
    for name, text in draft.spec.inputs.items():
        kind = InputSpec.parse(text).kind
        if draft.catalog.kind(kind) is None:
            near = did_you_mean(kind, KINDS)
            choices = "kinds: " + listed(KINDS) + ", or plugin.Kind"
            where = draft.where("inputs", name)
            draft.say(
                "VI209", f"there is no field kind {kind!r}", where, choices, f"{name}: {near}" if near else ""
            )


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
        edge = _edge(draft, ref, draft.where("outputs", name), None)
        if edge is not None:
            outputs[name] = edge
    inputs = {name: InputSpec.parse(text) for name, text in plain.inputs.items()}
    return Graph(spec, plain, inputs, loops, nodes, outputs, draft.catalog, file)


def _node(draft: Draft, name: str, node: NodeSpec, callee: Callee) -> Node:
    params = _params(draft, name, node.with_, callee, ("with",))
    at = {
        level: _params(draft, name, {**node.with_, **over}, callee, ("at", level))
        for level, over in node.at.items()
    }
    ins = _ins(draft, name, node, callee)
    feedback = dict(_feedbacks(draft, name, node, callee))
    _check_fed(draft, name, node, callee)
    return Node(name, callee, params, at, ins, feedback, node.loop, node.levels, node.of)  # type: ignore[arg-type]


def _params(
    draft: Draft, name: str, given: Mapping[str, Any], callee: Callee, path: tuple[str | int, ...]
) -> Params | Mapping[str, Any]:
    if callee.module is None:
        if given and callee.graph is not None:
            where = draft.where("nodes", name, *path)
            draft.say("VI205", f"{callee.id} is a graph and takes no parameters", where)
        return given
    try:
        return callee.module.Params.model_validate(dict(given))
    except ValidationError as error:
        for item in error.errors(include_input=False, include_url=False):
            _wrong_param(draft, item, callee, ("nodes", name, *path))
        return Params()


def _wrong_param(draft: Draft, item: Any, callee: Callee, path: tuple[str | int, ...]) -> None:
    assert callee.module is not None
    known = callee.module.Params.model_fields
    param = str(item["loc"][0]) if item["loc"] else ""
    choices = f"parameters of {callee.id}: " + listed(
        f"{name} = {info.default!r}" for name, info in known.items()
    )
    if item["type"] == "extra_forbidden":
        near = did_you_mean(param, known)
        where = draft.where(*path, param, key=True)
        found = f"{callee.id} has no parameter {param!r}"
        draft.say("VI205", found, where, choices, f"{near}: …" if near else "")
    else:
        said = str(item["msg"]).replace("Input should be", "should be").replace("Value error, ", "")
        draft.say("VI205", f"{param}: {said}" if param else said, draft.where(*path, param), choices)


def _ins(draft: Draft, name: str, node: NodeSpec, callee: Callee) -> dict[str, Edge | tuple[Edge, ...]]:
    ins: dict[str, Edge | tuple[Edge, ...]] = {}
    for port, refs in node.in_.items():
        where = draft.where("nodes", name, "in", port)
        target = _target(draft, callee, port, draft.where("nodes", name, "in", port, key=True), name)
        if target is None:
            continue
        if isinstance(refs, str):
            edge = _edge(draft, refs, where, target)
            if edge is not None:
                ins[port] = edge
        elif not target.many:
            write = f"{port}: {refs[0] if refs else 'node.port'}"
            draft.say("VI203", f"{port!r} of {callee.id} takes one value, not a list", where, "", write)
        else:
            edges = [_edge(draft, ref, where, target, listed_=True) for ref in refs]
            ins[port] = tuple(edge for edge in edges if edge is not None)
    return ins


def _target(draft: Draft, callee: Callee, port: str, where: Where, name: str) -> PortSpec | None:
    if port in callee.inputs:
        return callee.inputs[port]
    near = did_you_mean(port, callee.inputs)
    choices = f"inputs of {name!r} ({callee.id}): " + listed(f"{p}: {s}" for p, s in callee.inputs.items())
    draft.say("VI206", f"{callee.id} has no input {port!r}", where, choices, f"{near}:" if near else "")
    return None


def _edge(
    draft: Draft, ref: str, where: Where, target: PortSpec | None, *, listed_: bool = False
) -> Edge | None:
    """The edge from ``ref``, read as ``target`` wants it (as it is, for the graph's outputs)."""
    found = draft.source(ref, where)
    if found is None:
        return None
    source, spec = found
    kind = MAP_KIND if spec.kind == "Map" else draft.catalog.kind(spec.kind) or FieldKind(spec.kind, spec.array)
    if target is None:
        return Edge(source, "plain", kind)
    reader = reader_between(spec, target)
    many_fits = spec.many == (target.many and not listed_)
    if reader is None or not many_fits:
        _misfit(draft, source, spec, target, where)
        return None
    if spec.optional and not (target.optional or target.many):
        draft.say("VI204", f"{target.name!r} must be fed, but {ref!r} is optional and may be absent", where)
    return Edge(source, reader, KINDS["Image"] if reader == "luminance" else kind)


def _misfit(draft: Draft, ref: Any, source: PortSpec, target: PortSpec, where: Where) -> None:
    fitting = [
        f"{node}.{port}"
        for node, callee in draft.callees.items()
        for port, spec in callee.outputs.items()
        if spec.many == target.many and reader_between(spec, target)
    ]
    fitting += [
        f"{INPUTS}.{name}"
        for name in draft.spec.inputs
        if (spec := draft.input_port(name)).many == target.many and reader_between(spec, target)
    ]
    same = [one for one in fitting if one.startswith(f"{ref.node}.")]
    best = (same or fitting or [""])[0]
    wrap = (
        f"{target.name}: [{ref}]" if target.many and not source.many and reader_between(source, target) else ""
    )
    found = f"wants {target}; {str(ref)!r} is {source}"
    draft.say(
        "VI203", found, where, draft.outputs_of(ref.node), wrap or (f"{target.name}: {best}" if best else "")
    )


def _feedbacks(draft: Draft, name: str, node: NodeSpec, callee: Callee) -> Iterator[tuple[str, Feedback]]:
    for port, spec in node.feedback.items():
        path = ("nodes", name, "feedback", port)
        target = _target(draft, callee, port, draft.where(*path, key=True), name)
        if target is None:
            continue
        if port in node.in_:
            draft.say(
                "VI212", f"{port!r} is fed twice, by 'in' and by 'feedback'", draft.where(*path, key=True)
            )
        edge = _edge(draft, spec.from_, draft.where(*path, "from"), target)
        if edge is not None:
            loop = _carrying(draft, node, spec, path)
            if loop is not None:
                yield port, Feedback(edge, loop, _start(draft, spec, target, path), spec.restart)


def _carrying(draft: Draft, node: NodeSpec, spec: FeedbackSpec, path: tuple[str, ...]) -> str | None:
    """The innermost loop that holds both ends of a feedback edge."""
    source = draft.spec.nodes.get(spec.from_.partition(".")[0])
    ours, theirs = _chain(draft, node.loop), _chain(draft, source.loop if source else None)
    common = [loop for loop in ours if loop in theirs]
    if common:
        return common[-1]
    found = f"{path[1]!r} and {spec.from_!r} lie in no common loop, so there is no turn before"
    write = f"loop: {next(iter(draft.spec.loops), 'turns')}"
    draft.say("VI214", found, draft.where(*path), "loops: " + listed(draft.spec.loops), write)
    return None


def _chain(draft: Draft, loop: str | None) -> list[str]:
    chain: list[str] = []
    while loop is not None and loop in draft.spec.loops and loop not in chain:
        chain.append(loop)
        loop = draft.spec.loops[loop].inside
    return chain[::-1]


def _start(
    draft: Draft, spec: FeedbackSpec, target: PortSpec, path: tuple[str, ...]
) -> float | str | Edge | None:
    if isinstance(spec.start, str) and spec.start != "plane":
        return _edge(draft, spec.start, draft.where(*path, "start"), target)
    return spec.start


def _check_fed(draft: Draft, name: str, node: NodeSpec, callee: Callee) -> None:
    for port, spec in callee.inputs.items():
        if spec.optional or port in node.in_ or port in node.feedback or _has_default(callee, port):
            continue
        fitting = [
            f"{other}.{out}"
            for other, each in draft.callees.items()
            if other != name
            for out, given in each.outputs.items()
            if given.many == spec.many and reader_between(given, spec)
        ] + [
            f"{INPUTS}.{given}"
            for given in draft.spec.inputs
            if draft.input_port(given).many == spec.many and reader_between(draft.input_port(given), spec)
        ]
        by_name = [ref for ref in fitting if ref.endswith(f".{port}")]
        best = next(iter(by_name or fitting), "node.port")
        found = f"{callee.id} needs {port!r} ({spec}), and nothing feeds it"
        choices = "what would fit: " + listed(fitting)
        draft.say("VI204", found, draft.where("nodes", name, "in"), choices, f"{port}: {best}")


def _has_default(callee: Callee, port: str) -> bool:
    return callee.module is not None and not callee.module.Inputs.model_fields[port].is_required()


def _until(draft: Draft, name: str) -> Until | None:
    spec = draft.spec.loops[name].until
    if spec is None:
        return None
    path = ("loops", name, "until")
    change = spec.change_of and _edge(draft, spec.change_of, draft.where(*path, "change_of"), None)
    holds = spec.holds and _edge(draft, spec.holds, draft.where(*path, "holds"), None)
    return Until(spec, change or None, holds or None)
