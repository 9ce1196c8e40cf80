"""Variants of a graph: other parameters, a spoke left out, a control. Each is a new graph, bound anew."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from visint.errors import GraphError, Problem
from visint.graph.bind import bind
from visint.graph.callees import COMMIT
from visint.graph.graph import MAP, Graph
from visint.graph.read import Places
from visint.graph.spec import GraphSpec, NodeSpec, SpokeSpec, StepSpec
from visint.names import did_you_mean, listed

__all__ = ["alter"]

Settings = Mapping[str, Any]


def alter(
    graph: Graph, *, settings: Settings | None = None, without: Iterable[str] = (), control: str | None = None
) -> Graph:
    """A variant of ``graph``.

    Parameters
    ----------
    settings
        ``"node.param"`` → value; a spoke's steps are called ``<spoke>_cohere`` and ``<spoke>_reconcile``.
    without
        Spokes to leave out: the map passes through unchanged there.
    control
        The name of one of the graph's ``controls``, whose settings are then made.

    Raises
    ------
    GraphError
        VI219 if a node, spoke or control is named that is not there; whatever binding finds else.
    """
    spec = graph.spec
    if control is not None:
        spec = _set(spec, _control(spec, control))
    if settings:
        spec = _set(spec, settings)
    for spoke in without:
        spec = _without(spec, spoke)
    if spec is graph.spec:
        return graph
    return bind(spec, graph.catalog, Places(str(graph.file or spec.name)), graph.file)


def _control(spec: GraphSpec, name: str) -> Settings:
    if name not in spec.controls:
        raise _names_nothing("control", name, spec.controls)
    return spec.controls[name]


def _names_nothing(what: str, name: str, known: Iterable[str]) -> GraphError:
    near = did_you_mean(name, known)
    problem = Problem(
        "VI219", f"there is no {what} {name!r}", choices=f"{what}s: " + listed(known), write=near or ""
    )
    return GraphError(problem)


def _set(spec: GraphSpec, settings: Settings) -> GraphSpec:
    for key, value in settings.items():
        name, dot, param = key.partition(".")
        if not dot or not param:
            raise GraphError(Problem("VI219", f"{key!r} is no parameter", write="node.parameter=value"))
        spec = _set_one(spec, name, param, value)
    return spec


def _set_one(spec: GraphSpec, name: str, param: str, value: Any) -> GraphSpec:
    if name in spec.nodes:
        node = _with(spec.nodes[name], param, value)
        return spec.model_copy(update={"nodes": {**spec.nodes, name: node}})
    spokes = spec.hub.spokes if spec.hub else {}
    owner, _, step = name.rpartition("_")
    if name in spokes:
        spoke = _with(spokes[name], param, value)
    elif owner in spokes and step in ("cohere", "reconcile"):
        inner = _with(getattr(spokes[owner], step), param, value)
        name, spoke = owner, spokes[owner].model_copy(update={step: inner})
    elif spec.hub and step == "reconcile" and owner in spec.hub.reconcile:
        inner = _with(spec.hub.reconcile[owner], param, value)
        hub = spec.hub.model_copy(update={"reconcile": {**spec.hub.reconcile, owner: inner}})
        return spec.model_copy(update={"hub": hub})
    else:
        raise _names_nothing("node", name, [*spec.nodes, *spokes])
    assert spec.hub is not None
    hub = spec.hub.model_copy(update={"spokes": {**spokes, name: spoke}})
    return spec.model_copy(update={"hub": hub})


def _with(part: Any, param: str, value: Any) -> Any:
    part = part if isinstance(part, NodeSpec | SpokeSpec | StepSpec) else StepSpec()
    return part.model_copy(update={"with_": {**part.with_, param: value}})


def _without(spec: GraphSpec, spoke: str) -> GraphSpec:
    if spec.hub is not None and spoke in spec.hub.spokes:
        order = tuple(name for name in spec.hub.order if name != spoke)
        spokes = {name: _unfed(one, {spoke}) for name, one in spec.hub.spokes.items() if name != spoke}
        nodes = {name: _unfed(node, {spoke}) for name, node in spec.nodes.items()}
        hub = spec.hub.model_copy(update={"order": order, "spokes": spokes})
        return spec.model_copy(update={"hub": hub, "nodes": nodes})
    gone = {name for name, node in spec.nodes.items() if node.of == spoke}
    if not gone:
        known = spec.hub.order if spec.hub else {node.of for node in spec.nodes.values() if node.of}
        raise _names_nothing("spoke", spoke, sorted(known))
    return _without_nodes(spec, gone)


def _without_nodes(spec: GraphSpec, gone: set[str]) -> GraphSpec:
    """Plain nodes taken out; who read the map from a commit among them reads the map before it."""
    before = {}
    for name in gone:
        if spec.nodes[name].uses == COMMIT:
            before[name] = str(spec.nodes[name].in_["map"]).partition(".")[0]
    gone_for_good = gone - set(before)
    nodes = {
        name: _rewired(_unfed(node, gone_for_good), before)
        for name, node in spec.nodes.items()
        if name not in gone
    }
    if MAP in before:  # the last commit bears the name that the rest of the file reads
        last = _through(MAP, before)
        nodes = {MAP if name == last else name: _rewired(node, {last: MAP}) for name, node in nodes.items()}
        return spec.model_copy(update={"nodes": nodes})
    return spec.model_copy(update={"nodes": nodes})


def _through(name: str, before: Mapping[str, str]) -> str:
    while name in before:
        name = before[name]
    return name


def _unfed(node: Any, gone: set[str]) -> Any:
    def stays(ref: str) -> bool:
        return ref.partition(".")[0] not in gone

    ins = {
        port: refs if isinstance(refs, str) else tuple(ref for ref in refs if stays(ref))
        for port, refs in node.in_.items()
        if not isinstance(refs, str) or stays(refs)
    }
    feedback = {port: each for port, each in node.feedback.items() if stays(each.from_)}
    return node.model_copy(update={"in_": ins, "feedback": feedback})


def _rewired(node: NodeSpec, before: Mapping[str, str]) -> NodeSpec:
    def moved(ref: str) -> str:
        name, dot, port = ref.partition(".")
        return f"{_through(name, before)}{dot}{port}"

    ins = {
        port: moved(refs) if isinstance(refs, str) else tuple(moved(ref) for ref in refs)
        for port, refs in node.in_.items()
    }
    feedback = {
        port: each.model_copy(update={"from_": moved(each.from_)}) for port, each in node.feedback.items()
    }
    return node.model_copy(update={"in_": ins, "feedback": feedback})
