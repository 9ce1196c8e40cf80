"""Variants of a graph: other parameters, a spoke left out, a control. Each is a new graph, bound anew."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from visint.errors import GraphError, Problem, Where
from visint.graph.bind import bind
from visint.graph.callees import COMMIT
from visint.graph.graph import MAP, Graph
from visint.graph.read import Places
from visint.graph.rewire import rewired
from visint.graph.spec import GraphSpec, NodeSpec, SpokeSpec, StepSpec
from visint.names import did_you_mean, listed

__all__ = ["alter"]

Settings = Mapping[str, Any]
Part = TypeVar("Part", NodeSpec, SpokeSpec, StepSpec)


def alter(
    graph: Graph, *, settings: Settings | None = None, without: Iterable[str] = (), control: str | None = None
) -> Graph:
    """A variant of ``graph``.

    Parameters
    ----------
    settings
        ``"node.param"`` → value; a spoke's steps are called ``<spoke>_cohere`` and ``<spoke>_reconcile``, a
        field's ``<field>_reconcile``.
    without
        Spokes to leave out: the map passes through unchanged there. What reads a spoke's other outputs
        through an optional port or a list does without, and so do the graph's outputs and controls. The
        variant is a plain graph, with the hub spelled out.
    control
        The name of one of the graph's ``controls``, whose settings are then made.

    Raises
    ------
    GraphError
        VI219 if a node, spoke or control is named that is not there; whatever binding finds else.
    """
    asked = {**(_control(graph.spec, control) if control is not None else {}), **(settings or {})}
    if asked:
        graph = _with_settings(graph, asked)
    for spoke in without:
        graph = _bound(graph, _without(graph.plain_spec, spoke))
    return graph


def _with_settings(graph: Graph, asked: Settings) -> Graph:
    """What is wrong with a setting is told of the setting: no file holds it."""
    spec = _set(graph.spec, asked)
    try:
        return _bound(graph, spec)
    except GraphError as error:
        raise GraphError(_of_setting(problem, asked) for problem in error.problems) from None


def _of_setting(problem: Problem, asked: Settings) -> Problem:
    path = problem.where.path.split(".")
    for key, value in asked.items():
        name, _, param = key.partition(".")
        owner = name.removesuffix("_cohere").removesuffix("_reconcile")
        if path[-1] == param and (name in path or owner in path):
            write = re.sub(r"^(\w+): ", rf"{name}.\1=", problem.write)
            return replace(problem, where=Where(f"{key}={value}"[:100]), write=write, fault="usage")
    return problem


def _bound(graph: Graph, spec: GraphSpec) -> Graph:
    return bind(spec, graph.catalog, Places(str(graph.file or spec.name)), graph.file)


def _control(spec: GraphSpec, name: str) -> Settings:
    if name not in spec.controls:
        raise _names_nothing("control", name, spec.controls)
    return spec.controls[name]


def _names_nothing(what: str, name: str, known: Iterable[str], param: str = "") -> GraphError:
    known = list(known)
    near = did_you_mean(name, known) or next(iter(known), "")
    choices = f"{what}s: " + listed(known)
    write = f"{near}.{param}=…" if near and param else near
    return GraphError(Problem("VI219", f"there is no {what} {name!r}", choices=choices, write=write))


def _set(spec: GraphSpec, settings: Settings) -> GraphSpec:
    for key, value in settings.items():
        name, dot, param = key.partition(".")
        if not dot or not param:
            owner = spec.nodes.get(name) or (spec.hub.spokes.get(name) if spec.hub else None)
            write = f"{name}.parameter=value" if owner else "node.parameter=value"
            raise GraphError(Problem("VI219", f"{key!r} names no parameter of a node", write=write))
        spec = _set_one(spec, name, param, value)
    return spec


def _set_one(spec: GraphSpec, name: str, param: str, value: Any) -> GraphSpec:
    if name in spec.nodes:
        node = _with(spec.nodes[name], param, value)
        return spec.model_copy(update={"nodes": {**spec.nodes, name: node}})
    spokes = spec.hub.spokes if spec.hub else {}
    fields = spec.hub.reconcile if spec.hub else {}
    owner, _, step = name.rpartition("_")
    if name in spokes:
        return _with_hub(spec, spokes={**spokes, name: _with(spokes[name], param, value)})
    if owner in spokes and step in ("cohere", "reconcile"):
        spoke = spokes[owner].model_copy(update={step: _with(getattr(spokes[owner], step), param, value)})
        return _with_hub(spec, spokes={**spokes, owner: spoke})
    spelled_out = [one for one, node in spec.nodes.items() if node.of == owner and one.endswith(f"_{step}")]
    if spelled_out:
        nodes = {one: _with(spec.nodes[one], param, value) for one in spelled_out}
        return spec.model_copy(update={"nodes": {**spec.nodes, **nodes}})
    if owner in fields and step == "reconcile":
        return _with_hub(spec, reconcile={**fields, owner: _with(fields[owner], param, value)})
    raise _names_nothing("node", name, [*spec.nodes, *spokes], param)


def _with(part: Part, param: str, value: Any) -> Part:
    return part.model_copy(update={"with_": {**part.with_, param: value}})


def _with_hub(spec: GraphSpec, **parts: Any) -> GraphSpec:
    assert spec.hub is not None
    return spec.model_copy(update={"hub": spec.hub.model_copy(update=parts)})


def _without(spec: GraphSpec, spoke: str) -> GraphSpec:
    gone = {name for name, node in spec.nodes.items() if node.of == spoke}
    if not gone:
        raise _names_nothing("spoke", spoke, dict.fromkeys(node.of for node in spec.nodes.values() if node.of))
    gone |= _mute(spec, gone) | {f"{spoke}_cohere", f"{spoke}_reconcile"}
    before = {
        name: str(spec.nodes[name].in_["map"]).partition(".")[0]
        for name in gone & set(spec.nodes)
        if spec.nodes[name].uses == COMMIT
    }
    silent = gone - set(before)
    nodes = {
        name: rewired(_unfed(node, silent), before) for name, node in spec.nodes.items() if name not in gone
    }
    return _called_map(spec, nodes, before).model_copy(
        update={
            "outputs": {name: ref for name, ref in spec.outputs.items() if _stays(ref, silent)},
            "controls": {
                name: {key: value for key, value in settings.items() if _stays(key, gone)}
                for name, settings in spec.controls.items()
            },
        }
    )


def _mute(spec: GraphSpec, gone: set[str]) -> set[str]:
    """A field's reconciler, and its commit, if all its evidence came from nodes that are gone."""
    mute: set[str] = set()
    for name, node in spec.nodes.items():
        if node.uses == COMMIT and node.of is None:
            for source in {ref.partition(".")[0] for ref in map(str, node.in_.values())} & set(spec.nodes):
                fed = [refs for refs in spec.nodes[source].in_.values() if isinstance(refs, tuple)]
                if fed and not any(_stays(ref, gone) for refs in fed for ref in refs):
                    mute |= {name, source}
    return mute


def _called_map(spec: GraphSpec, nodes: dict[str, NodeSpec], before: Mapping[str, str]) -> GraphSpec:
    """The last commit bears the name that the rest of the file reads; where none is left, one is written."""
    if MAP not in before:
        return spec.model_copy(update={"nodes": nodes})
    last = MAP
    while last in before:
        last = before[last]
    if nodes[last].uses != COMMIT:
        empty = NodeSpec(uses=COMMIT, loop=nodes[last].loop, in_={"map": f"{last}.map"})
        readers = {name: rewired(node, {last: MAP}) for name, node in nodes.items()}
        return spec.model_copy(update={"nodes": {**readers, MAP: empty}})
    named = {MAP if name == last else name: rewired(node, {last: MAP}) for name, node in nodes.items()}
    return spec.model_copy(update={"nodes": named})


def _stays(ref: str, gone: set[str]) -> bool:
    return ref.partition(".")[0] not in gone


def _unfed(node: NodeSpec, gone: set[str]) -> NodeSpec:
    ins = {
        port: refs if isinstance(refs, str) else tuple(ref for ref in refs if _stays(ref, gone))
        for port, refs in node.in_.items()
        if not isinstance(refs, str) or _stays(refs, gone)
    }
    feedback = {port: each for port, each in node.feedback.items() if _stays(each.from_, gone)}
    return node.model_copy(update={"in_": ins, "feedback": feedback})
