"""visint modules: what is installed, and what each module takes and gives."""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visint.errors import PluginError, UsageError
from visint.names import ModuleId, did_you_mean

if TYPE_CHECKING:
    from visint.registry import Catalog

__all__ = ["EXAMPLES", "command"]

EXAMPLES = "Examples: visint modules;  visint modules stereo.sgm;  visint modules stereo.sgm --json"


def command(
    module: Annotated[str, typer.Argument(help="A module's id, such as stereo.sgm.")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
) -> None:
    """List the installed plugins and their modules, or tell what one module takes and gives."""
    from visint.registry import installed

    catalog = installed()
    if module:
        told = _describe(catalog, module)
        typer.echo(json.dumps(told, indent=1) if as_json else _page(told))
        return
    plugins = [_plugin(catalog, name) for name in catalog.plugin_names]
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
    module_id = ModuleId.parse(name)
    if module_id is None:
        raise UsageError.of("VI701", f"{name!r} is no module id", write="visint modules stereo.sgm")
    module = catalog.module(module_id)
    if module is None:
        known = [f"{module_id.plugin}.{one}" for one in catalog.plugin(module_id.plugin).modules]
        near = did_you_mean(name, known)
        choices = "modules: " + ", ".join(known)
        raise UsageError.of("VI201", f"no module is named {name!r}", choices=choices, write=near or "")
    schema = module.Params.model_json_schema()["properties"] if module.Params.model_fields else {}
    return {
        "module": name,
        "version": module.version,
        "about": inspect.getdoc(module) or "",
        "inputs": {port: str(spec) for port, spec in module.Inputs.specs.items()},
        "outputs": {port: str(spec) for port, spec in module.Outputs.specs.items()},
        "parameters": schema,
    }


def _page(told: dict[str, Any]) -> str:
    lines = [f"{told['module']} (version {told['version']})", "", told["about"], ""]
    for part in ("inputs", "outputs"):
        lines += [f"{part}:", *(f"  {name}: {spec}" for name, spec in told[part].items())]
    lines.append("parameters:")
    for name, schema in told["parameters"].items():
        about = " ".join(str(schema.get("description", "")).split())
        lines.append(f"  {name} = {schema.get('default')!r}" + (f"   {about}" if about else ""))
    return "\n".join(lines)
