"""A drawing in Graphviz's language: loops as clusters, feedback dashed, the failed node red."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from visint.graph.drawing.lettering import clean
from visint.graph.drawing.model import Box, Drawing, Edge, Group, Hub

__all__ = ["dot"]

_SHAPES: Mapping[str, str] = {
    "input": 'shape=box, style="rounded,filled", fillcolor="#eef1f4", color="#eef1f4"',
    "output": 'shape=box, style="rounded,filled", fillcolor="#eef1f4", color="#eef1f4"',
    "node": 'shape=box, style="rounded"',
    "spoke": 'shape=box, style="rounded", color="#0f766e"',
    "map": 'shape=ellipse, peripheries=2, style=filled, fillcolor="#e3f4f1", color="#0f766e"',
    "missing": 'shape=box, style=dashed, color="#c81e1e"',
}
_RED = 'color=red, fontcolor=red, penwidth=2.5, style="rounded"'


def dot(drawing: Drawing) -> str:
    """``drawing`` as the text of a ``.dot`` file."""
    names = {box.key: f"n{index}" for index, box in enumerate(drawing.root.every())}
    lines = [
        f"digraph {quoted(drawing.name)} {{",
        '  graph [rankdir=TB, fontname="Helvetica", compound=true];',
        '  node [fontname="Helvetica", fontsize=11];',
        '  edge [fontname="Helvetica", fontsize=9, color="#7f8c99"];',
        *_group(drawing, drawing.root, names, "  "),
        *(_edge(edge, names) for edge in drawing.edges),
        "}",
    ]
    return "\n".join(lines) + "\n"


def quoted(*lines: str) -> str:
    """``lines`` as one string of the language: quotes and backslashes stand for themselves."""
    safe = (clean(line).replace("\\", "\\\\").replace('"', '\\"') for line in lines if line)
    return '"' + "\\n".join(safe) + '"'


def _group(drawing: Drawing, group: Group, names: Mapping[str, str], indent: str) -> Iterator[str]:
    yield from (_box(drawing, box, names, indent) for box in group.boxes)
    if group.hub is not None:
        yield from _hub(drawing, group.hub, names, indent)
    for inner in group.groups:
        yield f"{indent}subgraph {quoted('cluster_' + inner.name)} {{"
        yield f"{indent}  label={quoted(inner.name, *inner.caption)}; labeljust=l;"
        yield f'{indent}  style=rounded; color="#b9c7d3";'
        yield from _group(drawing, inner, names, indent + "  ")
        yield f"{indent}}}"


def _hub(drawing: Drawing, hub: Hub, names: Mapping[str, str], indent: str) -> Iterator[str]:
    yield from (_box(drawing, box, names, indent) for box in (hub.map, *hub.spokes))
    middle = names[hub.map.key]
    for spoke in hub.spokes:
        yield f'{indent}{middle} -> {names[spoke.key]} [dir=both, color="#0f766e", penwidth=1.8];'


def _box(drawing: Drawing, box: Box, names: Mapping[str, str], indent: str) -> str:
    name = f"{box.turn}. {box.name}" if box.turn else box.name
    red = f", {_RED}" if box.key == drawing.failed else ""
    told = f"label={quoted(name, box.text)}, tooltip={quoted(*box.tip.splitlines())}, {_SHAPES[box.role]}{red}"
    return f"{indent}{names[box.key]} [{told}];"


def _edge(edge: Edge, names: Mapping[str, str]) -> str:
    back = ', style=dashed, constraint=false, color="#b45309"' if edge.feedback else ""
    taken = f", taillabel={quoted(edge.out)}" if edge.out and edge.out != edge.into else ""
    label = f"label={quoted(edge.into)}{taken}{back}"
    return f"  {names[edge.source]} -> {names[edge.target]} [{label}];"
