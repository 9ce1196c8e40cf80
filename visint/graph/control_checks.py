"""The rule that controls must keep: they set parameters that there are, to values that they can have."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from pydantic import ValidationError

from visint.errors import Problem
from visint.graph.complaints import shown
from visint.graph.draft import Draft
from visint.graph.graph import Graph, Node
from visint.graph.write import as_written
from visint.names import did_you_mean, listed

__all__ = ["controls_set_parameters"]


class _Fault(NamedTuple):
    found: str
    choices: str
    write: str


def controls_set_parameters(graph: Graph, draft: Draft) -> Iterator[Problem]:
    """A control sets parameters that there are, to values that they can have."""
    for control, settings in graph.spec.controls.items():
        for key, value in settings.items():
            fault = _fault(graph, key, value)
            if fault is not None:
                where = draft.where("controls", control, key, key=True)
                write = f"{control}: {{{fault.write}}}"
                yield Problem("VI219", fault.found, where, fault.choices, write)


def _fault(graph: Graph, key: str, value: Any) -> _Fault | None:
    name, _, param = key.partition(".")
    node = graph.nodes.get(name) or _step(graph, name)
    if node is None:
        return _no_node(graph, name, param, value)
    known = _parameters(node)
    choices = f"parameters of {name!r}: " + listed(known)
    if node.callee.module is None or param not in known:
        near = did_you_mean(param, known) or next(iter(known), "")
        write = f"{name}.{near}: {as_written(value)}" if near else "…"
        return _Fault(f"{name!r} ({node.callee.id}) has no parameter {param[:70]!r}", choices, write)
    try:
        node.callee.module.Params.model_validate({**known, param: value})
    except ValidationError as error:
        said = str(error.errors(include_input=False, include_url=False)[0]["msg"])
        found = f"found {shown(value)}; " + said.replace("Input should be", "should be")
        return _Fault(found, choices, f"{key}: {as_written(known[param])}")
    return None


def _step(graph: Graph, name: str) -> Node | None:
    """A step of a spoke with several kinds of evidence: one node a kind, set together by the spoke's name."""
    spoke, _, step = name.rpartition("_")
    found = (node for one, node in graph.nodes.items() if node.of == spoke and one.endswith(f"_{step}"))
    return next(found, None) if step in ("cohere", "reconcile") else None


def _no_node(graph: Graph, name: str, param: str, value: Any) -> _Fault:
    known = {one: _parameters(node) for one, node in graph.nodes.items()}
    settable = [one for one, parameters in known.items() if parameters]
    near = did_you_mean(name, settable) or next(iter(settable), "node")
    parameters = known.get(near, {})
    right = did_you_mean(param, parameters) or next(iter(parameters), "parameter")
    write = f"{near}.{right}: {as_written(value)}"
    return _Fault(f"there is no node {name[:70]!r}", "nodes with parameters: " + listed(settable), write)


def _parameters(node: Node) -> dict[str, Any]:
    """The parameters of a node's module with their values in the graph."""
    if node.callee.module is None:
        return {}
    return {name: getattr(node.params, name) for name in node.callee.module.Params.model_fields}
