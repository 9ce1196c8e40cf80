"""visint schema: the JSON schema of graph files, for editors."""

from __future__ import annotations

import json
from typing import Annotated

import typer

__all__ = ["EXAMPLES", "command"]

EXAMPLES = "Example: visint schema --installed > visint.schema.json"


def command(
    with_installed: Annotated[
        bool, typer.Option("--installed", help="Spell out the installed modules and their parameters.")
    ] = False,
) -> None:
    """Print the JSON schema of graph files, for editors that complete and check as you type."""
    from visint.graph import json_schema
    from visint.registry import installed

    typer.echo(json.dumps(json_schema(installed() if with_installed else None), indent=1))
