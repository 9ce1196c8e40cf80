"""visint check: read, bind and check a graph; run nothing."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from visint.cli.complete import graphs
from visint.errors import GraphError, VisintError

__all__ = ["EXAMPLES", "command"]

EXAMPLES = "Examples: visint check stereo_sgm;  visint check mine.yaml;  visint check mine.yaml --json"


def command(
    graph: Annotated[
        str, typer.Argument(help="A graph file, or the name of a shipped graph.", autocompletion=graphs)
    ],
    as_json: Annotated[bool, typer.Option("--json", help="Problems as JSON on stdout.")] = False,
) -> None:
    """Read, bind and check a graph; run nothing. Tells all problems of a phase at once."""
    from visint.graph import load

    try:
        bound = load(graph)
    except GraphError as error:
        if not as_json:
            raise
        typer.echo(json.dumps(_problems(error), indent=1))
        raise typer.Exit(error.exit_code) from None
    if as_json:
        typer.echo("[]")
    else:
        parts = [
            _counted(len(bound.nodes), "node"),
            *([_counted(len(bound.loops), "loop")] if bound.loops else []),
        ]
        typer.echo(f"{bound.name}: {', '.join(parts)}, outputs {', '.join(bound.outputs)}: sound")


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _problems(error: VisintError) -> list[dict[str, object]]:
    return [
        {
            "code": problem.code,
            "file": problem.where.file,
            "line": problem.where.line,
            "column": problem.where.column,
            "path": problem.where.path,
            "found": problem.found,
            "choices": problem.choices,
            "write": problem.write,
            "fault": problem.fault,
        }
        for problem in error.problems
    ]
