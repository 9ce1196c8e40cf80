"""Finding what a node's ``uses`` means: a module, a graph, or the engine's own keeping of the map."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace

from visint.arrays import ArraySpec
from visint.errors import PluginError, Where
from visint.fields.kinds import KINDS, FieldKind
from visint.graph.draft import Draft
from visint.graph.graph import Callee, Edge, Graph
from visint.graph.spec import GraphSpec, InputSpec
from visint.module import PortSpec
from visint.names import ModuleId, did_you_mean, is_name, listed
from visint.registry import Catalog

__all__ = ["BEGIN", "COMMIT", "find_callee", "map_ports", "plugins_named", "stored_fields"]

BEGIN, COMMIT = "map.begin", "map.commit"
"""The engine's own nodes: the map at the start of a sweep, and the map with new fields."""


def find_callee(draft: Draft, uses: str, where: Where) -> Callee | None:
    """What ``uses`` names; None, with a problem noted, if it names nothing."""
    if uses in (BEGIN, COMMIT):
        return _map_callee(draft, uses)
    prefix, colon, name = uses.partition(":")
    if colon:
        return _graph_callee(draft, prefix, name, where)
    module = ModuleId.parse(uses)
    if module is None:
        found = f"{uses[:70]!r} is no module; one is written plugin.module"
        known = {each.partition(".")[2]: each for each in _known_modules(draft)}
        near = known.get(did_you_mean(uses.rpartition(".")[2].lower(), known) or "", "plugin.module")
        choices = "plugins: " + listed(draft.catalog.plugin_names)
        draft.say("VI201", found, where, choices, f"uses: {near}")
        return None
    return _module_callee(draft, module, where)


def _known_modules(draft: Draft) -> Iterator[str]:
    """The ids of all modules of the plugins that are loaded."""
    for plugin in draft.catalog.loaded:
        for name in plugin.modules:
            yield f"{plugin.name}.{name}"


def _module_callee(draft: Draft, module: ModuleId, where: Where) -> Callee | None:
    names = draft.catalog.plugin_names
    if module.plugin not in names:
        near = did_you_mean(module.plugin, names)
        write = f"uses: {near}.{module.name}" if near else "pip install …   (the plugin that brings it)"
        draft.say("VI201", f"no plugin is named {module.plugin!r}", where, "plugins: " + listed(names), write)
        return None
    try:
        plugin = draft.catalog.plugin(module.plugin)
    except PluginError as error:
        draft.problems.extend(replace(problem, where=where) for problem in error.problems)
        return None
    found = plugin.modules.get(module.name)
    if found is None:
        near = did_you_mean(module.name, plugin.modules)
        choices = f"modules of {module.plugin!r}: " + listed(f"{module.plugin}.{m}" for m in plugin.modules)
        write = f"uses: {module.plugin}.{near or 'module'}"
        draft.say("VI201", f"{module.plugin!r} has no module {module.name!r}", where, choices, write)
        return None
    return Callee(str(module), found.Inputs.specs, found.Outputs.specs, module=found, origin=plugin.origin)


def _graph_callee(draft: Draft, prefix: str, name: str, where: Where) -> Callee | None:
    from visint.graph.load import load_named

    known = draft.catalog.graphs()
    if prefix != "graph" or not is_name(name) or name not in known:
        near = did_you_mean(name, known)
        write = f"uses: graph:{near or next(iter(known), 'name')}"
        found = f"{f'{prefix}:{name}'[:70]!r} names no installed graph"
        draft.say("VI201", found, where, "graphs: " + listed(known), write)
        return None
    if name in draft.calling:
        circle = " → ".join([*draft.calling[draft.calling.index(name) :], name])
        found = f"the graph {name!r} calls itself: {circle}"
        others = "other graphs: " + listed(one for one in known if one not in draft.calling)
        draft.say(
            "VI218", found, where, others, "uses: plugin.module   (or a graph that does not call this one)"
        )
        return None
    graph = load_named(name, draft.catalog, draft.calling)
    inputs = {
        port: PortSpec(port, spec.kind, _array(draft.catalog, spec.kind), spec.optional, spec.many)
        for port, spec in graph.inputs.items()
    }
    outputs = {port: _given(graph, port, edge) for port, edge in graph.outputs.items()}
    return Callee(f"graph:{name}", inputs, outputs, graph=graph)


def _given(graph: Graph, name: str, edge: Edge) -> PortSpec:
    """An output of a graph as a port: what its source gives, or None where that does not run at full size."""
    node = graph.nodes.get(edge.source.node)
    if node is None:
        spec = graph.inputs[edge.source.port]
        return PortSpec(name, spec.kind, edge.kind.array, spec.optional, spec.many)
    absent = node.levels is not None and 0 not in node.levels
    port = node.callee.outputs[edge.source.port]
    return replace(port, name=name, optional=port.optional or absent)


def _array(catalog: Catalog, kind: str) -> ArraySpec | None:
    found = catalog.kind(kind)
    return found.array if found else None


def stored_fields(catalog: Catalog, plugins: Iterable[str] = ()) -> Mapping[str, FieldKind]:
    """The fields the map stores: depth, boundaries, and those that kinds of ``plugins`` constrain.

    ``plugins`` are the ones that a graph names, whatever else is loaded: a graph means the same everywhere.
    A broken one is passed over here, for its node tells of it.
    """
    fields = {"depth": KINDS["Depth"], "boundaries": KINDS["Boundaries"]}
    for name in sorted(set(plugins) & {*catalog.plugin_names}):
        with suppress(PluginError):
            for kind in catalog.plugin(name).fields.values():
                if kind.constrains:
                    fields.setdefault(kind.constrains, kind)
    return fields


def plugins_named(spec: GraphSpec) -> set[str]:
    """The plugins that a graph names: those of its modules, of its policy and of its inputs' kinds."""
    uses = [node.uses for node in spec.nodes.values()]
    uses += [InputSpec.parse(text).kind for text in spec.inputs.values()]
    if spec.hub is not None:
        spokes = spec.hub.spokes.values()
        steps = [
            *(step for one in spokes for step in (one.cohere, one.reconcile)),
            *spec.hub.reconcile.values(),
        ]
        uses += [spec.hub.uses or "", *(one.uses for one in spokes), *(step.uses or "" for step in steps)]
    return {one.partition(".")[0] for one in uses}


_DERIVED = {"disparity": "Disparity", "normals": "Normals", "slopes": "Slopes", "regions": "Regions"}


def map_ports(draft: Draft) -> dict[str, PortSpec]:
    """What can be read from the map: stored and derived fields, and the confidence of the stored ones.

    What has no start may be None, and so may what follows from it.
    """
    absent = {field: not _starts_with(draft.spec, field) for field in draft.fields}
    ports = {"map": PortSpec("map", "Map")}
    for field, kind in draft.fields.items():
        optional = absent[field]
        ports[field] = PortSpec(field, kind.name, kind.array, optional)
        confidence = f"{field}_confidence"
        ports[confidence] = PortSpec(confidence, "Confidence", KINDS["Confidence"].array, optional)
    for field, name in _DERIVED.items():
        optional = absent["boundaries" if field == "regions" else "depth"]
        ports[field] = PortSpec(field, name, KINDS[name].array, optional)
    return ports


def _starts_with(spec: GraphSpec, field: str) -> bool:
    """Whether a field of the map always has a value; one from a reference may be absent, depth apart."""
    begins = [spec.hub.start] if spec.hub else [one.with_ for one in spec.nodes.values() if one.uses == BEGIN]
    starts = [begin.get(field, "plane" if field == "depth" else None) for begin in begins]
    given = [start for start in starts if start not in (None, "none")]
    return (
        bool(starts) and len(given) == len(starts) and (field == "depth" or not any(map(_is_reference, given)))
    )


def _is_reference(start: object) -> bool:
    return isinstance(start, str) and start != "plane"


def _map_callee(draft: Draft, uses: str) -> Callee:
    """``map.begin`` or ``map.commit`` as a node sees it; every stored field is an optional input.

    A commit takes a field as it is (``depth``, with ``depth_confidence``) or straight from evidence
    (``depth_evidence``), which then replaces the map wherever it speaks.
    """
    outputs = map_ports(draft)
    inputs = {"map": PortSpec("map", "Map", optional=uses == BEGIN)}
    if uses == BEGIN:
        inputs["camera"] = PortSpec("camera", "Camera", optional=True)
    for field in draft.fields:
        for port in (field, f"{field}_confidence"):
            inputs[port] = replace(outputs[port], optional=True)
        if uses == COMMIT:
            given = f"{field}_evidence"
            inputs[given] = PortSpec(given, "", KINDS["Depth"].array, optional=True, evidence=True)
    return Callee(uses, inputs, outputs)
