"""The JSON schema of graph files, for editors; with the installed modules spelled out if asked."""

from __future__ import annotations

from typing import Any

from visint.errors import PluginError
from visint.graph.spec import GraphSpec
from visint.registry import Catalog

__all__ = ["json_schema"]


def json_schema(catalog: Catalog | None = None) -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a graph file.

    Parameters
    ----------
    catalog
        If given, ``uses`` is limited to its modules and graphs, and ``with`` to each module's parameters.
        Plugins that cannot be loaded are left out.
    """
    schema = GraphSpec.model_json_schema(by_alias=True)
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["title"] = "visint graph file"
    if catalog is not None:
        for part in ("NodeSpec", "SpokeSpec"):
            _spell_out(schema["$defs"][part], catalog)
    return schema


def _spell_out(part: dict[str, Any], catalog: Catalog) -> None:
    uses, branches = [f"graph:{name}" for name in catalog.graphs()], []
    for name in catalog.plugin_names:
        try:
            plugin = catalog.plugin(name)
        except PluginError:
            continue
        for module in plugin.modules.values():
            module_id = f"{name}.{module.name}"
            uses.append(module_id)
            params = module.Params.model_json_schema()
            branches.append(
                {
                    "if": {"properties": {"uses": {"const": module_id}}},
                    "then": {"properties": {"with": params}},
                }
            )
    part["properties"]["uses"]["enum"] = sorted([*uses, "map.begin", "map.commit"])
    part["allOf"] = branches
