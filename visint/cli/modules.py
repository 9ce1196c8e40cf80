"""visint modules: what is installed, and what each module takes and gives."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Iterator, Mapping
from textwrap import indent
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visint.cli import complete
from visint.errors import PluginError, UsageError, VisintError
from visint.names import ModuleId, did_you_mean, listed

if TYPE_CHECKING:
    from visint.registry import Catalog

__all__ = ["EXAMPLES", "command"]

EXAMPLES = "Examples: visint modules;  visint modules stereo.sgm;  visint modules stereo.sgm --json"

_PARTS = ("inputs", "outputs", "parameters")


def command(
    module: Annotated[
        str,
        typer.Argument(
            help="A module's id, such as stereo.sgm, or a plugin's name.", autocompletion=complete.modules
        ),
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
) -> None:
    """List the installed plugins and their modules, or tell what one module takes and gives."""
    from visint.registry import installed

    catalog = installed()
    if module and module not in catalog.plugin_names:
        told = _describe(catalog, module)
        typer.echo(json.dumps(told, indent=1) if as_json else _page(told))
        return
    plugins = [_plugin(catalog, name) for name in catalog.plugin_names if module in ("", name)]
    typer.echo(json.dumps(plugins, indent=1) if as_json else "\n".join(_lines(plugins)))
    if any("broken" in plugin for plugin in plugins):
        raise typer.Exit(PluginError.exit_code)


def _plugin(catalog: Catalog, name: str) -> dict[str, Any]:
    try:
        plugin = catalog.plugin(name)
    except PluginError as error:
        return {"plugin": name, "broken": str(error)}
    modules = {f"{name}.{each.name}": _summary(each) for each in plugin.modules.values()}
    return {"plugin": name, "from": plugin.origin, "modules": modules, "policies": sorted(plugin.policies)}


def _lines(plugins: list[dict[str, Any]]) -> Iterator[str]:
    for plugin in plugins:
        if "broken" in plugin:
            yield f"{plugin['plugin']}: BROKEN\n{plugin['broken']}"
            continue
        yield f"{plugin['plugin']} ({plugin['from']})"
        yield from (f"  {name:28} {summary}" for name, summary in plugin["modules"].items())
        yield from (f"  {plugin['plugin']}.{name}: a hub policy" for name in plugin["policies"])


def _summary(module: type) -> str:
    return (inspect.getdoc(module) or "").partition("\n")[0]


def _describe(catalog: Catalog, name: str) -> dict[str, Any]:
    from visint.fields.assumptions import meaning

    module_id = ModuleId.parse(name)
    module = None
    if module_id is not None and module_id.plugin in catalog.plugin_names:
        module = catalog.module(module_id)
    if module is None:
        raise _unknown(catalog, name)
    schema = module.Params.model_json_schema()["properties"] if module.Params.model_fields else {}
    return {
        "module": name,
        "version": module.version,
        "about": inspect.getdoc(module) or "",
        "inputs": {port: str(spec) for port, spec in module.Inputs.specs.items()},
        "outputs": {port: str(spec) for port, spec in module.Outputs.specs.items()},
        "parameters": schema,
        "assumptions": {name: meaning(name) for name in module.assumptions},
        "notes": {
            part: inspect.getdoc(model) or ""
            for part, model in zip(_PARTS, (module.Inputs, module.Outputs, module.Params), strict=True)
            if model.__module__ != "visint.module" and "__doc__" in vars(model)
        },
    }


def _unknown(catalog: Catalog, name: str) -> VisintError:
    """Every module that there is, broken plugins' apart, and the one that was meant."""
    plugins = [_plugin(catalog, plugin) for plugin in catalog.plugin_names]
    known = [one for plugin in plugins for one in plugin.get("modules", ())]
    by_name = {one.partition(".")[2]: one for one in known}  # who forgets the plugin means the module
    last = name.rpartition(".")[2]
    near = did_you_mean(name, [*known, *catalog.plugin_names]) or by_name.get(did_you_mean(last, by_name) or "")
    write = f"visint modules {near}" if near else "visint modules   (all of them, with a line each)"
    return UsageError.of(
        "VI201", f"no module is named {name!r}", choices="modules: " + listed(known), write=write
    )


def _page(told: dict[str, Any]) -> str:
    lines = [f"{told['module']} (version {told['version']})", "", told["about"], ""]
    for part in _PARTS:
        lines.append(f"{part}:")
        if part == "parameters":
            lines += [_parameter(name, schema) for name, schema in told[part].items()]
        else:
            lines += [f"  {name}: {spec}" for name, spec in told[part].items()]
        lines += ["", indent(told["notes"].get(part, ""), "    "), ""]
    if told["assumptions"]:
        lines += ["assumptions:", *(_assumption(*each) for each in told["assumptions"].items())]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip()


def _assumption(name: str, says: str) -> str:
    return f"  {name}: {says}" if says else f"  {name}"


def _parameter(name: str, schema: Mapping[str, Any]) -> str:
    about = " ".join(str(schema.get("description", "")).split())
    default = f" = {json.dumps(schema['default'])}" if "default" in schema else ""
    return f"  {name}{default}" + (f"   {about}" if about else "")
