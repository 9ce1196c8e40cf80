"""The verbs of the program, those of plugins among them: found without importing, imported when called."""

from __future__ import annotations

import ast
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from visint.registry.discover import Entry, discover, only

__all__ = ["Verbs"]


class Verbs(TyperGroup):
    """Built-in verbs first, then those of plugins. A broken plugin's verb is listed, and fails when called.

    Contexts and commands are Any: newer typers bring a click of their own, older ones use click's.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Every verb, in order."""
        own = super().list_commands(ctx)
        return [*own, *(name for name in discover("visint.commands") if name not in own)]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The verb ``cmd_name``; a plugin's is imported only where it is about to run."""
        own = super().get_command(ctx, cmd_name)
        if own is not None:
            return own
        entries = discover("visint.commands").get(cmd_name)
        if entries is None:
            return None
        if cmd_name in (*ctx._protected_args, *ctx.args):  # it is about to run, not only listed
            return _loaded(only(entries))
        return TyperCommand(cmd_name, help=_summary(entries[0]))


def _loaded(entry: Entry) -> Any:
    from visint.registry.load import import_entry

    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    app.command(name=entry.name)(import_entry(entry))
    return typer.main.get_command(app)


def _summary(entry: Entry) -> str:
    """The first line of the docstring of the verb's module, read as text."""
    top, *rest = entry.target.module.split(".")
    spec = PathFinder.find_spec(top)
    if spec is None or spec.origin is None:
        return f"(from {entry.origin})"
    path = Path(spec.origin).parent.joinpath(*rest)
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            doc = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
            return doc.partition("\n")[0] or f"(from {entry.origin})"
    return f"(from {entry.origin})"
