"""The verbs of the program, those of plugins among them: found without importing, imported when called."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from visint.errors import UsageError
from visint.names import did_you_mean, listed
from visint.registry.discover import Entry, discover, only

__all__ = ["Verbs", "listed_examples"]


class Verbs(TyperGroup):
    """Built-in verbs first, then those of plugins. A broken plugin's verb is listed, and fails when called.

    Contexts and commands are Any: newer typers bring a click of their own, older ones use click's.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Every verb, in order."""
        own = super().list_commands(ctx)
        return [*own, *(name for name in discover("visint.commands") if name not in own)]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The verb ``cmd_name``; a plugin's as it stands in the list of verbs, nothing imported."""
        own = super().get_command(ctx, cmd_name)
        if own is not None:
            return own
        entries = discover("visint.commands").get(cmd_name)
        return entries and TyperCommand(cmd_name, short_help=_summary(entries[0]))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The verb that is about to run, a plugin's imported, and the arguments left for it.

        Raises
        ------
        UsageError
            VI701 if there is no such verb.
        PluginError
            VI501 if its plugin is broken, VI502 if two distributions bring it.
        """
        verb, known = args[0], self.list_commands(ctx)
        if not verb.startswith("-") and verb not in known:
            near = did_you_mean(verb, known)
            write = f"visint {near}" if near else ""
            raise UsageError.of(
                "VI701", f"there is no verb {verb!r}", choices="verbs: " + listed(known), write=write
            )
        if verb not in known or super().get_command(ctx, verb) is not None:
            return super().resolve_command(ctx, args)
        return verb, _loaded(only(discover("visint.commands")[verb])), args[1:]


def listed_examples(examples: str | None) -> str | None:
    """The examples of a verb for its help: a line each, as they can be pasted."""
    if not examples:
        return None
    head, _, lines = examples.partition(": ")
    return f"\b\n{head}:\n" + "\n".join(f"  {line.strip()}" for line in lines.split(";  "))


def _loaded(entry: Entry) -> Any:
    from visint.registry.load import import_entry

    function = import_entry(entry)
    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    examples = getattr(sys.modules.get(function.__module__), "EXAMPLES", None)
    app.command(name=entry.name, epilog=listed_examples(examples))(function)
    return typer.main.get_command(app)


def _summary(entry: Entry) -> str:
    """The first line of the docstring of the verb's function, or of its file, read as text."""
    for file in _files(entry):
        try:
            tree = ast.parse(file.read_text(encoding="utf-8"))
        except (OSError, ValueError, SyntaxError):
            break  # what is wrong with it is said when it is called
        functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
        called = [node for node in functions if node.name == entry.target.attr]
        docs = [ast.get_docstring(node) for node in called] + [ast.get_docstring(tree)]
        return next((doc.partition("\n")[0].rstrip(".") for doc in docs if doc), f"(from {entry.origin})")
    return f"(from {entry.origin})"


def _files(entry: Entry) -> Iterator[Path]:
    top, *rest = entry.target.module.split(".")
    spec = PathFinder.find_spec(top)
    if spec is not None and spec.origin is not None:
        home = Path(spec.origin) if not rest else Path(spec.origin).parent.joinpath(*rest)
        yield from (file for file in (home.with_suffix(".py"), home / "__init__.py") if file.is_file())
