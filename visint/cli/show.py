"""visint show: a graph as it will run, as the plain graph it stands for, or drawn."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from visint.errors import UsageError

if TYPE_CHECKING:
    from visint.graph import Graph
    from visint.schedule import Block, Step

__all__ = ["EXAMPLES", "command"]

EXAMPLES = (
    "Examples: visint show stereo;  visint show mine.yaml --expand > plain.yaml;  "
    "visint show stereo --html > stereo.html"
)


def command(
    graph: Annotated[str, typer.Argument(help="A graph file, or the name of a shipped graph.")],
    expand: Annotated[
        bool, typer.Option("--expand", help="The plain graph of a hub, as a graph file.")
    ] = False,
    dot: Annotated[bool, typer.Option("--dot", help="Drawn, for Graphviz; loads no plugin.")] = False,
    html: Annotated[bool, typer.Option("--html", help="Drawn, as a page; loads no plugin.")] = False,
    failed: Annotated[str, typer.Option(help="A node to draw in red.")] = "",
) -> None:
    """Show the order in which a graph runs, the plain graph behind a hub, or a drawing."""
    from visint.graph import drawing, load

    if expand + dot + html > 1:
        raise UsageError.of("VI701", "--expand, --dot and --html exclude each other")
    if dot or html:
        spec = drawing.spec_of(graph)
        typer.echo(drawing.to_dot(spec, failed) if dot else drawing.to_html(spec, failed), nl=False)
        return
    bound = load(graph)
    typer.echo(bound.expanded() if expand else "\n".join(_lines(bound)), nl=not expand)


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
