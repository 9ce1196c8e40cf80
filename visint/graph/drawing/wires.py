"""The edges of a spec as drawn: references resolved to boxes, the hub's own traffic left to its spokes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from visint.graph.drawing.model import Edge
from visint.graph.graph import INPUTS, MAP
from visint.graph.spec import FeedbackSpec, GraphSpec, SpokeSpec, StepSpec

__all__ = ["MISSING", "input_key", "node_key", "output_key", "ports", "spoke_key", "wires"]

MISSING = "missing "
"""What the key of a reference that points nowhere begins with."""

Ins = Mapping[str, "str | tuple[str, ...]"]


def input_key(name: str) -> str:
    """The key of an input's box."""
    return f"input {name}"


def output_key(name: str) -> str:
    """The key of an output's box."""
    return f"output {name}"


def node_key(name: str) -> str:
    """The key of a node's box."""
    return f"node {name}"


def spoke_key(name: str) -> str:
    """The key of a spoke's box."""
    return f"spoke {name}"


def wires(spec: GraphSpec) -> tuple[Edge, ...]:
    """All edges, each once, in the order of the spec."""
    return tuple(dict.fromkeys(_all(spec)))


def _all(spec: GraphSpec) -> Iterator[Edge]:
    for name, node in spec.nodes.items():
        yield from _ins(spec, node_key(name), node.in_)
        yield from _feedback(spec, node_key(name), node.feedback)
    yield from _hub(spec)
    for name, ref in spec.outputs.items():
        yield _edge(spec, ref, output_key(name), "")


def _hub(spec: GraphSpec) -> Iterator[Edge]:
    if spec.hub is None:
        return
    starts = {f"start {name}": str(start) for name, start in spec.hub.start.items() if _is_ref(start)}
    yield from _ins(spec, MAP, starts)
    for name, step in spec.hub.reconcile.items():
        yield from _step(spec, MAP, name, step)
    for name, spoke in spec.hub.spokes.items():
        yield from _spoke(spec, spoke_key(name), spoke)


def _spoke(spec: GraphSpec, key: str, spoke: SpokeSpec) -> Iterator[Edge]:
    """A spoke reads the map anyway: an in-edge that says so is no edge of its own."""
    yield from (edge for edge in _ins(spec, key, spoke.in_) if edge.source != MAP)
    yield from _step(spec, key, "cohere", spoke.cohere)
    yield from _step(spec, key, "reconcile", spoke.reconcile)
    yield from _feedback(spec, key, spoke.feedback)


def _step(spec: GraphSpec, key: str, verb: str, step: StepSpec) -> Iterator[Edge]:
    """A step reads the spoke it belongs to, and the map, anyway."""
    named = {f"{verb} {port}": refs for port, refs in step.in_.items()}
    return (edge for edge in _ins(spec, key, named) if edge.source not in (key, MAP))


def _ins(spec: GraphSpec, key: str, ins: Ins) -> Iterator[Edge]:
    for port, refs in ins.items():
        yield from (_edge(spec, ref, key, port) for ref in ([refs] if isinstance(refs, str) else refs))


def _feedback(spec: GraphSpec, key: str, feedback: Mapping[str, FeedbackSpec]) -> Iterator[Edge]:
    for port, edge in feedback.items():
        yield _edge(spec, edge.from_, key, port, feedback=True)
        if _is_ref(edge.start):
            yield _edge(spec, str(edge.start), key, f"{port} (start)")


def _is_ref(start: object) -> bool:
    return isinstance(start, str) and start != "plane"


def _edge(spec: GraphSpec, ref: str, target: str, port: str, feedback: bool = False) -> Edge:
    name, _, out = ref.partition(".")
    source = _source(spec, name, out)
    if source is None:
        return Edge(MISSING + ref, "", target, port, feedback)
    return Edge(source, "" if name == INPUTS else out, target, port, feedback)


def _source(spec: GraphSpec, name: str, out: str) -> str | None:
    if name == INPUTS:
        return input_key(out) if out in spec.inputs else None
    if spec.hub is not None and name == MAP:
        return MAP
    if spec.hub is not None and name in spec.hub.spokes:
        return spoke_key(name)
    return node_key(name) if name in spec.nodes else None


def ports(edges: Iterable[Edge], key: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The ports of the box ``key`` that an edge enters, and those that one leaves."""
    ins = dict.fromkeys(edge.into for edge in edges if edge.target == key)
    outs = dict.fromkeys(edge.out for edge in edges if edge.source == key)
    return tuple(ins), tuple(outs)
