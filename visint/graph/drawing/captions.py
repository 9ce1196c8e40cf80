"""The words of a drawing: how a loop ends, what a tooltip tells."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from visint.graph.drawing.lettering import clean
from visint.graph.spec import FeedbackSpec, HubSpec, LoopSpec, NodeSpec, SpokeSpec, StepSpec, UntilSpec

__all__ = ["hub_tip", "levels_text", "loop_caption", "module_text", "node_tip", "spoke_tip"]


def loop_caption(loop: LoopSpec) -> tuple[str, ...]:
    """How often a loop goes round, and what ends it sooner: a line each."""
    return tuple(clean(line) for line in _loop_lines(loop))


def _loop_lines(loop: LoopSpec) -> Iterator[str]:
    yield _bound(loop)
    if loop.between:
        yield "between levels " + ", ".join(f"{kind}: {way}" for kind, way in loop.between.items())
    if loop.until is not None:
        yield _until(loop.until)
    if loop.on_exhausted != "accept":
        yield f"else {loop.on_exhausted}"


def _bound(loop: LoopSpec) -> str:
    if loop.over == "pyramid":
        if loop.levels is not None:
            return f"coarse to fine, {_count(loop.levels, 'level')}"
        return "coarse to fine" + (f", coarsest {loop.coarsest}" if loop.coarsest is not None else "")
    return f"at most {_count(loop.times, 'turn')}" if loop.times is not None else "no bound given"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def _until(until: UntilSpec) -> str:
    if until.holds is not None:
        return f"until {until.holds} holds"
    running = f", {until.patience} turns running" if until.patience > 1 else ""
    bound = f" < {until.below:g}" if until.below is not None else " is small"
    return f"until the change of {until.change_of}{bound}{running}"


def levels_text(levels: tuple[int, ...] | None) -> str:
    """``levels 0–3`` where they follow each other, ``levels 0, 2`` where not; empty for all levels."""
    if levels is None:
        return ""
    if len(levels) == 1:
        return f"level {levels[0]}"
    if len(levels) > 2 and list(levels) == list(range(levels[0], levels[0] + len(levels))):
        return f"levels {levels[0]}–{levels[-1]}"
    return "levels " + (", ".join(map(str, levels)) or "none")


def module_text(node: NodeSpec | SpokeSpec) -> str:
    """What a box says under its name."""
    return " · ".join(filter(None, (node.uses, levels_text(node.levels))))


def node_tip(name: str, node: NodeSpec) -> str:
    """All that the graph file says about a node, a line each."""
    return _lines(name, _node_lines(node))


def spoke_tip(name: str, spoke: SpokeSpec, turn: int) -> str:
    """All that the graph file says about a spoke, its steps included."""
    return _lines(f"{name} (spoke {turn})", [*_node_lines(spoke), *_step_lines(spoke)])


def hub_tip(hub: HubSpec) -> str:
    """What the hub starts with, the order of its spokes, and what is reconciled once a sweep."""
    return _lines("map", _hub_lines(hub))


def _hub_lines(hub: HubSpec) -> Iterator[str]:
    if hub.uses:
        yield f"policy: {hub.uses}"
    starts = {field: "none" if start is None else start for field, start in hub.start.items()}
    yield from (f"start of {field}: {start}" for field, start in starts.items())
    yield "order: " + ", ".join(hub.order)
    yield from (_step(f"once a sweep, {field}", step) for field, step in hub.reconcile.items())


def _node_lines(node: NodeSpec | SpokeSpec) -> Iterator[str]:
    yield f"uses: {module_text(node)}"
    yield from _settings(node.with_)
    for level, settings in node.at.items():
        yield from (f"at level {level}, {line}" for line in _settings(settings))
    for port, refs in node.in_.items():
        yield f"{port} < {refs if isinstance(refs, str) else ', '.join(refs)}"
    yield from (_feedback(port, edge) for port, edge in node.feedback.items())


def _feedback(port: str, edge: FeedbackSpec) -> str:
    start = "none" if edge.start is None else edge.start
    anew = f", anew at every turn of {edge.restart}" if edge.restart else ""
    return f"{port} << {edge.from_}, the turn before (start: {start}{anew})"


def _step_lines(spoke: SpokeSpec) -> Iterator[str]:
    for verb, step in (("cohere", spoke.cohere), ("reconcile", spoke.reconcile)):
        if step != StepSpec():
            yield _step(verb, step)


def _step(verb: str, step: StepSpec) -> str:
    told = ", ".join(filter(None, (step.uses or "by the policy", *_settings(step.with_))))
    return f"{verb}: {told}"


def _settings(settings: Mapping[str, Any]) -> Iterator[str]:
    return (f"{name} = {value}" for name, value in settings.items())


def _lines(head: str, rest: Iterator[str] | list[str]) -> str:
    return "\n".join(clean(line)[:200] for line in (head, *rest))
