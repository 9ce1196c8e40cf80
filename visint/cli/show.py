"""visint show: a graph as it will run, as the plain graph it stands for, or drawn."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visint.cli.complete import graphs
from visint.errors import UsageError

if TYPE_CHECKING:
    from visint.graph import Graph
    from visint.schedule import Block, Step

__all__ = ["EXAMPLES", "command"]

EXAMPLES = (
    "Examples: visint show stereo;  visint show mine.yaml --expand > plain.yaml;  "
    "visint show stereo --html > stereo.html;  visint show stereo --json"
)


def command(
    graph: Annotated[
        str, typer.Argument(help="A graph file, or the name of a shipped graph.", autocompletion=graphs)
    ],
    expand: Annotated[
        bool, typer.Option("--expand", help="The plain graph of a hub, as a graph file.")
    ] = False,
    dot: Annotated[bool, typer.Option("--dot", help="Drawn, for Graphviz; loads no plugin.")] = False,
    html: Annotated[bool, typer.Option("--html", help="Drawn, as a page; loads no plugin.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="The order as JSON on stdout.")] = False,
    failed: Annotated[str, typer.Option(help="A node to draw in red.")] = "",
) -> None:
    """Show the order in which a graph runs, the plain graph behind a hub, or a drawing."""
    from visint.graph import drawing, load

    if expand + dot + html + as_json > 1:
        raise UsageError.of("VI701", "--expand, --dot, --html and --json exclude each other")
    if dot or html:
        spec = drawing.spec_of(graph)
        typer.echo(drawing.to_dot(spec, failed) if dot else drawing.to_html(spec, failed), nl=False)
        return
    bound = load(graph)
    if as_json:
        typer.echo(json.dumps(_told(bound), indent=1))
        return
    typer.echo(bound.expanded() if expand else "\n".join(_lines(bound)), nl=not expand)


def _told(graph: Graph) -> dict[str, Any]:
    from visint.schedule import compile_graph

    return {
        "name": graph.name,
        "about": graph.spec.about,
        "inputs": {name: str(spec) for name, spec in graph.inputs.items()},
        "order": _told_block(compile_graph(graph).root),
        "outputs": {name: str(edge.source) for name, edge in graph.outputs.items()},
    }


def _told_block(block: Block) -> list[dict[str, Any]]:
    from visint.schedule import Step

    told: list[dict[str, Any]] = []
    for item in block.items:
        if isinstance(item, Step):
            node = item.node
            fed = {port: str(edge.source) for port, edge in node.edges()}
            back = {port: str(feedback.edge.source) for port, feedback in node.feedback.items()}
            told.append({"node": node.name, "uses": node.callee.id, "in": fed, "feedback": back})
        else:
            spec = item.loop.spec.model_dump(exclude_defaults=True, by_alias=True, mode="json")
            told.append({"loop": item.loop.name, **spec, "body": _told_block(item.body)})
    return told


def _lines(graph: Graph) -> Iterator[str]:
    from visint.schedule import compile_graph

    yield f"{graph.name}" + (f": {graph.spec.about}" if graph.spec.about else "")
    for name, spec in graph.inputs.items():
        yield f"  input {name}: {spec}"
    yield from _block(compile_graph(graph).root, "  ")
    for name, edge in graph.outputs.items():
        yield f"  output {name}: {edge.source} ({edge.kind.name})"


def _block(block: Block, indent: str) -> Iterator[str]:
    from visint.schedule import Step

    for item in block.items:
        if isinstance(item, Step):
            yield from _step(item, indent)
        else:
            spec = item.loop.spec.model_dump(exclude_defaults=True, by_alias=True)
            told = ", ".join(f"{key}: {_flow(value)}" for key, value in spec.items() if key != "inside")
            yield f"{indent}loop {item.loop.name} ({told})"
            yield from _block(item.body, indent + "  ")


def _flow(value: object) -> str:
    """``value`` as a graph file spells it on one line."""
    if not isinstance(value, dict):
        return str(value)
    return "{" + ", ".join(f"{key}: {_flow(inner)}" for key, inner in value.items()) + "}"


def _step(step: Step, indent: str) -> Iterator[str]:
    node = step.node
    fed = [f"{port} < {edge.source}" for port, edge in node.edges()]
    fed += [f"{port} << {feedback.edge.source}" for port, feedback in node.feedback.items()]
    unbound = [port for port in node.callee.inputs if port not in node.ins and port not in node.feedback]
    yield f"{indent}{node.name}: {node.callee.id}  ({', '.join(fed)})" + (
        f"  unbound: {', '.join(unbound)}" if unbound and node.callee.module else ""
    )
