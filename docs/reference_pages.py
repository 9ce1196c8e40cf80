"""Makes the generated pages of the reference, from the code and the help as they are."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docstrings import parameters_in, prose

__all__ = ["write_all"]

DOI = re.compile(r"doi:\s*(10\.\d{4,}/[^\s,;]+[^\s,;.)])", re.IGNORECASE)


def write_all(folder: Path) -> None:
    """Writes every generated page into ``folder``, leaving pages that did not change alone."""
    folder.mkdir(parents=True, exist_ok=True)
    makers = {
        "errors": errors,
        "modules": modules,
        "hooks": hooks,
        "kinds": kinds,
        "assumptions": assumptions,
        "cli": command_line,
        "schema": schema,
    }
    for name, lines in makers.items():
        write(folder / f"{name}.md", "\n".join(lines()) + "\n")


def write(path: Path, text: str) -> None:
    """Writes ``text``, unless it stands there already: then nothing is built anew for it."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def errors() -> Iterator[str]:
    """Every error code with what it means, and which exception and exit code goes with it."""
    from visint import errors as module

    yield "# Errors\n\nEvery message begins with its code. Codes that begin alike belong to one class.\n"
    yield "| code | means |\n|---|---|"
    yield from (f"| `{code}` | {meaning} |" for code, meaning in module.CODES.items())
    yield "\n## The tree of exceptions\n\n```text"
    yield inspect.cleandoc(module.__doc__ or "").split("::\n")[1].rsplit("\n\n", 1)[0]
    yield "```"


def modules() -> Iterator[str]:
    """Every installed module: what it recovers and assumes, takes, gives and can be told."""
    from visint.registry import installed

    yield "# Modules\n\nWhat is installed here; `visint modules ID` tells the same of one.\n"
    catalog = installed()
    for name in catalog.plugin_names:
        plugin = catalog.plugin(name)
        yield f"\n## {name}"
        for module in plugin.modules.values():
            yield from _module(f"{name}.{module.name}", module)
        yield from (f"\n### {name}.{policy}\n\nA hub policy." for policy in plugin.policies)


def _module(name: str, module: Any) -> Iterator[str]:
    about = inspect.getdoc(module) or ""
    yield f"\n### {name}\n\n{prose(about)}\n"
    sources = sorted(set(DOI.findall(about)))
    if sources:
        yield "Source: " + ", ".join(f"[doi:{doi}](https://doi.org/{doi})" for doi in sources) + "\n"
    yield "| port | | kind | unit |\n|---|---|---|---|"
    for way, model in (("in", module.Inputs), ("out", module.Outputs)):
        for port, spec in model.specs.items():
            unit = spec.array.unit if spec.array is not None and spec.array.unit != "1" else ""
            yield f"| `{port}` | {way} | {spec} | {unit} |"
    yield from _notes(module)
    yield from _parameters(module.Params)
    yield from _rests_on(module)


def _notes(module: Any) -> Iterator[str]:
    for title, model in (("in", module.Inputs), ("out", module.Outputs)):
        if model.__module__ != "visint.module" and vars(model).get("__doc__"):
            yield f"\n*{title}:* {prose(inspect.getdoc(model) or '')}"


def _parameters(params: Any) -> Iterator[str]:
    if not params.model_fields:
        return
    told = parameters_in(inspect.getdoc(params) or "")
    yield "\n| parameter | default | |\n|---|---|---|"
    for name, field in params.model_fields.items():
        default = "required" if field.is_required() else f"`{field.default!r}`"
        yield f"| `{name}` | {default} | {told.get(name, '')} |"
    if not told:  # a line of prose does for one parameter
        yield f"\n{prose(inspect.getdoc(params) or '')}"


def _rests_on(module: Any) -> Iterator[str]:
    from visint.fields.assumptions import meaning

    if module.assumptions:
        yield "\n**Assumptions**\n"
        yield from (f"* `{name}`: {meaning(name)}" for name in module.assumptions)


def assumptions() -> Iterator[str]:
    """Every named assumption, and the modules that rest on it."""
    from visint.fields.assumptions import ASSUMPTIONS
    from visint.registry import installed

    catalog = installed()
    resting: dict[str, list[str]] = {}
    for plugin in catalog.plugin_names:
        for module in catalog.plugin(plugin).modules.values():
            for name in module.assumptions:
                resting.setdefault(name, []).append(f"`{plugin}.{module.name}`")
    yield "# Assumptions\n"
    yield "The premises that modules declare and, where they can, test. What a run found of each"
    yield "stands in its report.\n\n| name | says | modules that rest on it |\n|---|---|---|"
    for name, says in ASSUMPTIONS.items():
        yield f"| `{name}` | {says} | {', '.join(resting.get(name, ['–']))} |"


def hooks() -> Iterator[str]:
    """Every hook with its exact signature."""
    from visint import hookspecs

    yield f"# Hooks\n\n```text\n{inspect.cleandoc(hookspecs.__doc__ or '')}\n```"
    for name, hook in vars(hookspecs).items():
        if name.startswith("visint_"):
            signature = f"```python\ndef {name}{inspect.signature(hook)}\n```"
            yield f"\n## {name}\n\n{signature}\n\n{prose(inspect.getdoc(hook) or '')}"


def kinds() -> Iterator[str]:
    """The table of field kinds, and the classes of evidence."""
    from visint import fields
    from visint.fields import kinds as module
    from visint.fields.evidence import Evidence

    yield f"# Field kinds\n\n```text\n{inspect.cleandoc(module.__doc__ or '')}\n```"
    yield "\n## Evidence\n\n| class | measures | constrains |\n|---|---|---|"
    for name in fields.__all__:
        kind = getattr(fields, name)
        if isinstance(kind, type) and issubclass(kind, Evidence) and kind.measures:
            constrains = module.KINDS[kind.measures].constrains
            yield f"| `{name}` | {kind.measures} | {constrains} |"


def command_line() -> Iterator[str]:
    """The help of every verb, plugins' verbs included, as printed."""
    from typer.testing import CliRunner

    from visint.cli.main import application
    from visint.registry.discover import discover

    yield "# Command line"
    runner, app = CliRunner(), application()
    own = [command.name for command in app.registered_commands]
    for verb in ("", *own, *discover("visint.commands")):
        words = [*([verb] if verb else []), "--help"]
        shown = runner.invoke(app, words, prog_name="visint", env={"COLUMNS": "90", "TERM": "dumb"}).output
        yield f"\n## visint {verb}\n\n```text\n{shown.strip()}\n```"


def schema() -> Iterator[str]:
    """The JSON schema of graph files, as ``visint schema`` prints it."""
    from visint.graph import json_schema

    yield "# Schema of graph files\n"
    yield "`visint schema` prints this for your editor; `visint schema --installed` the same"
    yield "with every installed module and its parameters.\n"
    yield f"```json\n{json.dumps(json_schema(), indent=1)}\n```"
