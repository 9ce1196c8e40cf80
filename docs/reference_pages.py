"""Makes the generated pages of the reference: modules, errors, hooks, field kinds, the command line."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from pathlib import Path

__all__ = ["write_all"]


def write_all(folder: Path) -> None:
    """Writes every generated page into ``folder``, leaving pages that did not change alone."""
    folder.mkdir(parents=True, exist_ok=True)
    makers = {"errors": errors, "modules": modules, "hooks": hooks, "kinds": kinds, "cli": command_line}
    for name, lines in makers.items():
        text = "\n".join(lines()) + "\n"
        path = folder / f"{name}.md"
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def errors() -> Iterator[str]:
    """Every error code with what it means."""
    from visint import errors as module

    yield "# Errors\n\nEvery message begins with its code.\n\n| code | means |\n|---|---|"
    yield from (f"| `{code}` | {meaning} |" for code, meaning in module.CODES.items())
    yield "\n## The tree of exceptions\n\n```text"
    yield inspect.cleandoc(module.__doc__ or "").split("::\n")[1].rsplit("\n\n", 1)[0]
    yield "```"


def modules() -> Iterator[str]:
    """Every installed module: what it takes, gives and can be told."""
    from visint.registry import installed

    yield "# Modules"
    catalog = installed()
    for name in catalog.plugin_names:
        yield f"\n## {name}"
        for module in catalog.plugin(name).modules.values():
            yield f"\n### {name}.{module.name}\n\n```text\n{inspect.getdoc(module)}\n```\n"
            yield "| port | | kind |\n|---|---|---|"
            yield from (f"| `{port}` | in | {spec} |" for port, spec in module.Inputs.specs.items())
            yield from (f"| `{port}` | out | {spec} |" for port, spec in module.Outputs.specs.items())
            if module.Params.model_fields:
                yield f"\n```text\n{inspect.getdoc(module.Params)}\n```"


def hooks() -> Iterator[str]:
    """Every hook with its exact signature."""
    from visint import hookspecs

    yield f"# Hooks\n\n```text\n{inspect.cleandoc(hookspecs.__doc__ or '')}\n```"
    for name, hook in vars(hookspecs).items():
        if name.startswith("visint_"):
            signature = f"```python\ndef {name}{inspect.signature(hook)}\n```"
            yield f"\n## {name}\n\n{signature}\n\n{inspect.getdoc(hook)}"


def kinds() -> Iterator[str]:
    """The table of field kinds."""
    from visint.fields import kinds as module

    yield f"# Field kinds\n\n```text\n{inspect.cleandoc(module.__doc__ or '')}\n```"


def command_line() -> Iterator[str]:
    """The help of every verb, as printed."""
    from typer.testing import CliRunner

    from visint.cli.main import application

    yield "# Command line"
    runner, app = CliRunner(), application()
    for verb in ("", "run", "check", "show", "modules", "schema", "demo"):
        words = [*([verb] if verb else []), "--help"]
        shown = runner.invoke(app, words, prog_name="visint", env={"COLUMNS": "90", "TERM": "dumb"}).output
        yield f"\n## visint {verb}\n\n```text\n{shown.strip()}\n```"
