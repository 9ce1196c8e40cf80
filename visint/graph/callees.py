"""Finding what a node's ``uses`` means: a module, a graph, or the engine's own keeping of the map."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from visint.arrays import ArraySpec
from visint.errors import PluginError, Where
from visint.fields.kinds import KINDS, FieldKind
from visint.graph.draft import Draft
from visint.graph.graph import MAP, Callee, Graph
from visint.graph.spec import NodeSpec
from visint.module import PortSpec
from visint.names import ModuleId, did_you_mean, is_name, listed
from visint.registry import Catalog

__all__ = ["BEGIN", "COMMIT", "find_callee", "map_callee", "map_ports", "stored_fields"]

BEGIN, COMMIT = "map.begin", "map.commit"
"""The engine's own nodes: the map at the start of a sweep, and the map with new fields."""

CallGraph = Callable[[str], Graph | None]


def find_callee(draft: Draft, uses: str, where: Where, call_graph: CallGraph) -> Callee | None:
    """What ``uses`` names; None, with a problem noted, if it names nothing."""
    if uses in (BEGIN, COMMIT):
        return map_callee(uses, draft.catalog)
    prefix, colon, name = uses.partition(":")
    if colon:
        return _graph_callee(draft, prefix, name, where, call_graph)
    module = ModuleId.parse(uses)
    if module is None:
        found = f"{uses!r} is no module; one is written plugin.module"
        draft.say("VI201", found, where, "plugins: " + listed(draft.catalog.plugin_names))
        return None
    return _module_callee(draft, module, where)


def _module_callee(draft: Draft, module: ModuleId, where: Where) -> Callee | None:
    names = draft.catalog.plugin_names
    if module.plugin not in names:
        near = did_you_mean(module.plugin, names)
        write = f"uses: {near}.{module.name}" if near else ""
        draft.say("VI201", f"no plugin is named {module.plugin!r}", where, "plugins: " + listed(names), write)
        return None
    try:
        plugin = draft.catalog.plugin(module.plugin)
    except PluginError as error:
        draft.problems.extend(error.problems)
        return None
    found = plugin.modules.get(module.name)
    if found is None:
        near = did_you_mean(module.name, plugin.modules)
        choices = f"modules of {module.plugin!r}: " + listed(f"{module.plugin}.{m}" for m in plugin.modules)
        write = f"uses: {module.plugin}.{near}" if near else ""
        draft.say("VI201", f"{module.plugin!r} has no module {module.name!r}", where, choices, write)
        return None
    return Callee(str(module), found.Inputs.specs, found.Outputs.specs, module=found, origin=plugin.origin)


def _graph_callee(draft: Draft, prefix: str, name: str, where: Where, call_graph: CallGraph) -> Callee | None:
    known = draft.catalog.graphs()
    if prefix != "graph" or not is_name(name) or name not in known:
        near = did_you_mean(name, known)
        write = f"uses: graph:{near}" if near else ""
        found = f"{prefix}:{name} names no installed graph"
        draft.say("VI201", found, where, "graphs: " + listed(known), write)
        return None
    graph = call_graph(name)
    if graph is None:
        found = f"the graph {name!r} calls itself, through {draft.spec.name!r}"
        draft.say("VI218", found, where)
        return None
    inputs = {
        port: PortSpec(port, spec.kind, _array(draft.catalog, spec.kind), spec.optional, spec.many)
        for port, spec in graph.inputs.items()
    }
    outputs = {port: PortSpec(port, edge.kind.name, edge.kind.array) for port, edge in graph.outputs.items()}
    return Callee(f"graph:{name}", inputs, outputs, graph=graph)


def _array(catalog: Catalog, kind: str) -> ArraySpec | None:
    found = catalog.kind(kind)
    return found.array if found else None


def stored_fields(catalog: Catalog) -> Mapping[str, FieldKind]:
    """The fields the map stores: depth, boundaries, and those that kinds of the loaded plugins constrain."""
    fields = {"depth": KINDS["Depth"], "boundaries": KINDS["Boundaries"]}
    for plugin in catalog.loaded:
        for kind in plugin.fields.values():
            if kind.constrains:
                fields.setdefault(kind.constrains, kind)
    return fields


_DERIVED = {"disparity": "Disparity", "normals": "Normals", "slopes": "Slopes", "regions": "Regions"}


def map_ports(catalog: Catalog) -> dict[str, PortSpec]:
    """What can be read from the map: stored and derived fields, and the confidence of the stored ones.

    Every one may be None (a field that starts as ``none``) except what follows from depth.
    """
    ports = {"map": PortSpec("map", "Map")}
    for field, kind in stored_fields(catalog).items():
        ports[field] = PortSpec(field, kind.name, kind.array, optional=field != "depth")
        confidence = f"{field}_confidence"
        array = KINDS["Confidence"].array
        ports[confidence] = PortSpec(confidence, "Confidence", array, optional=field != "depth")
    for field, name in _DERIVED.items():
        ports[field] = PortSpec(field, name, KINDS[name].array, optional=field == "regions")
    return ports


def map_callee(uses: str, catalog: Catalog) -> Callee:
    """``map.begin`` or ``map.commit`` as a node sees it; every stored field is an optional input.

    A commit takes a field as it is (``depth``, with ``depth_confidence``) or straight from evidence
    (``depth_evidence``), which then replaces the map wherever it speaks.
    """
    outputs = map_ports(catalog)
    inputs = {"map": PortSpec("map", "Map", optional=uses == BEGIN)}
    if uses == BEGIN:
        inputs["camera"] = PortSpec("camera", "Camera", optional=True)
    for field in stored_fields(catalog):
        for port in (field, f"{field}_confidence"):
            spec = outputs[port]
            inputs[port] = PortSpec(port, spec.kind, spec.array, optional=True)
        if uses == COMMIT:
            given = f"{field}_evidence"
            inputs[given] = PortSpec(given, "", KINDS["Depth"].array, optional=True, evidence=True)
    return Callee(uses, inputs, outputs)


def is_map(spec: NodeSpec) -> bool:
    """Whether a node keeps the map."""
    return spec.uses.partition(".")[0] == MAP
