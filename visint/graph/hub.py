"""Spelling out a hub: spokes and the steps of their evidence become plain nodes around the engine's map.

The map begins a sweep as ``map_begin``; each spoke's fields are committed by a node of their own
(``map_<spoke>``), and the last commit is called ``map``, so that ``map.depth`` reads the same before and after.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from visint.graph.callees import BEGIN, COMMIT, find_callee, map_ports, stored_fields
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, MAP, Callee
from visint.graph.ports import reader_between
from visint.graph.spec import FeedbackSpec, GraphSpec, HubSpec, NodeSpec, SpokeSpec, StepSpec
from visint.module import PortSpec
from visint.names import did_you_mean, listed

__all__ = ["expand"]

Refs = dict[str, Any]


@dataclass(slots=True)
class _Expansion:
    """The plain graph as far as it is written: its nodes, and which node is the map now."""

    draft: Draft
    hub: HubSpec
    policy: Mapping[str, Mapping[str, Any]]
    nodes: dict[str, NodeSpec] = field(default_factory=dict)
    origins: dict[str, tuple[str, ...]] = field(default_factory=dict)
    callees: dict[str, Callee] = field(default_factory=dict)
    current: str = "map_begin"
    pending: dict[str, list[str]] = field(default_factory=dict)  # field → evidence kept for its reconciler

    def add(self, name: str, spec: NodeSpec, callee: Callee | None, *origin: str) -> str:
        if name in self.draft.spec.nodes or name in self.nodes:
            where = self.draft.where(*origin)
            self.draft.say("VI223", f"the hub wants to call a node {name!r}; the name is taken", where)
        self.nodes[name] = spec
        self.origins[name] = origin
        if callee is not None:
            self.callees[name] = callee
        return name


def expand(draft: Draft) -> None:
    """Replaces the hub of ``draft.spec`` by plain nodes; problems are noted in the draft."""
    hub = draft.spec.hub
    assert hub is not None
    _check_order(draft, hub)
    expansion = _Expansion(draft, hub, _policy(draft, hub))
    if draft.problems:
        return
    _begin(expansion)
    for name in hub.order:
        _spoke(expansion, name, hub.spokes[name])
    _reconcile_fields(expansion)
    _end(expansion)
    _check_reconcile(expansion)
    draft.spec = _plain(draft.spec, expansion)
    draft.origins = expansion.origins


def _check_order(draft: Draft, hub: HubSpec) -> None:
    for index, name in enumerate(hub.order):
        where = draft.where("hub", "order", index)
        if name not in hub.spokes:
            near = did_you_mean(name, hub.spokes)
            draft.say(
                "VI221", f"there is no spoke {name!r}", where, "spokes: " + listed(hub.spokes), near or ""
            )
        if name in hub.order[:index]:
            draft.say("VI212", f"the spoke {name!r} stands twice in the order", where)
    for name in hub.spokes:
        if name not in hub.order:
            where = draft.where("hub", "spokes", name, key=True)
            draft.say(
                "VI221",
                f"the spoke {name!r} is missing from 'order'",
                where,
                "",
                f"order: [{listed([*hub.order, name])}]",
            )


def _policy(draft: Draft, hub: HubSpec) -> Mapping[str, Mapping[str, Any]]:
    if hub.uses is None:
        return {}
    plugin, _, name = hub.uses.partition(".")
    where = draft.where("hub", "uses")
    if plugin not in draft.catalog.plugin_names:
        near = did_you_mean(plugin, draft.catalog.plugin_names)
        plugins = "plugins: " + listed(draft.catalog.plugin_names)
        draft.say(
            "VI201", f"no plugin is named {plugin!r}", where, plugins, f"uses: {near}.{name}" if near else ""
        )
        return {}
    found = draft.catalog.policy(hub.uses)
    if found is None:
        known = draft.catalog.plugin(plugin).policies
        choices = f"policies of {plugin!r}: " + listed(f"{plugin}.{one}" for one in known)
        draft.say("VI201", f"{plugin!r} has no hub policy {name!r}", where, choices)
    return found or {}


def _begin(expansion: _Expansion) -> None:
    draft, hub = expansion.draft, expansion.hub
    refs: Refs = {}
    starts: dict[str, Any] = {}
    for name, start in hub.start.items():
        if isinstance(start, str) and start != "plane":
            refs[name] = start
        else:
            starts[name] = "none" if start is None else start
        if name not in stored_fields(draft.catalog):
            known = listed(stored_fields(draft.catalog))
            draft.say(
                "VI215",
                f"the map stores no field {name!r}",
                draft.where("hub", "start", name, key=True),
                f"fields: {known}",
            )
    camera = _input_of_kind(draft, "Camera")
    if camera is not None:
        refs["camera"] = camera
    feedback = {"map": FeedbackSpec(from_=f"{MAP}.map")} if hub.loop else {}
    node = NodeSpec(uses=BEGIN, with_=starts, loop=hub.loop, in_=refs, feedback=feedback)
    expansion.add("map_begin", node, None, "hub")


def _input_of_kind(draft: Draft, kind: str) -> str | None:
    found = [name for name in draft.spec.inputs if draft.input_port(name).kind == kind]
    return f"{INPUTS}.{found[0]}" if len(found) == 1 else None


def _spoke(expansion: _Expansion, name: str, spoke: SpokeSpec) -> None:
    draft, hub = expansion.draft, expansion.hub
    origin = ("hub", "spokes", name)
    callee = find_callee(draft, spoke.uses, draft.where(*origin, "uses"), lambda _: None)
    if callee is None:
        return
    refs = _bound(expansion, callee, spoke.in_, {*spoke.feedback}, {}, origin)
    node = NodeSpec(
        uses=spoke.uses, with_=spoke.with_, loop=hub.loop, levels=spoke.levels, at=spoke.at, in_=refs,
        feedback=spoke.feedback, of=name,
    )  # fmt: skip
    expansion.add(name, node, callee, *origin)
    fields: Refs = {}
    evidence = [port for port in callee.outputs.values() if port.evidence]
    for port in evidence:
        stem = name if len(evidence) == 1 else f"{name}_{port.name}"
        fields |= _enter(expansion, name, stem, port, spoke)
    if fields:
        _commit(expansion, f"map_{name}", fields, name, origin)


def _bound(
    expansion: _Expansion,
    callee: Callee,
    own: Mapping[str, Any],
    fed: set[str],
    other: Mapping[str, str],
    origin: tuple[str, ...],
) -> Refs:
    """Ports by name: own ``in``, then the spoke's other outputs, then the map, then the graph's inputs."""
    draft = expansion.draft
    refs: Refs = {port: _now(expansion, ref) for port, ref in own.items()}
    fields = map_ports(draft.catalog)
    for port, spec in callee.inputs.items():
        if port in refs or port in fed:
            continue
        if port in other:
            refs[port] = other[port]
        elif port in fields and port in draft.spec.inputs:
            found = f"{port!r} could be the map's field or the graph's input"
            write = f"in: {{{port}: {INPUTS}.{port}}}"
            draft.say("VI220", found, draft.where(*origin), f"{MAP}.{port}, {INPUTS}.{port}", write)
        elif port in fields and port != "map" and reader_between(fields[port], spec):
            refs[port] = f"{expansion.current}.{port}"
        elif port in draft.spec.inputs:
            refs[port] = f"{INPUTS}.{port}"
    return refs


def _now(expansion: _Expansion, refs: Any) -> Any:
    """``map.field`` as of this point of the sweep."""
    if isinstance(refs, tuple):
        return tuple(_now(expansion, ref) for ref in refs)
    node, dot, port = refs.partition(".")
    return f"{expansion.current}{dot}{port}" if node == MAP else refs


def _enter(expansion: _Expansion, name: str, stem: str, port: PortSpec, spoke: SpokeSpec) -> Refs:
    """Adds the steps by which one evidence port enters the map; gives the fields to commit."""
    draft = expansion.draft
    kind = draft.catalog.kind(port.kind)
    field_name = kind.constrains if kind else ""
    origin = ("hub", "spokes", name)
    ref = _cohere(expansion, stem, f"{name}.{port.name}", port, spoke, origin)
    if field_name in expansion.hub.reconcile:
        expansion.pending.setdefault(field_name, []).append(ref)
        return {}
    step = _step(expansion, port, "reconcile", spoke.reconcile, "replace")
    if step.uses == "none":
        return {}
    if step.uses == "replace":
        if port.kind in ("Depth", "Boundaries", "Disparity") or (
            kind and kind.constrains not in ("depth", "boundaries", "")
        ):
            return {f"{field_name}_evidence": ref}
        found = f"{port} says something about {field_name or 'no field'!r} but cannot replace it"
        write = "reconcile: {uses: plugin.module}"
        draft.say(
            "VI222", found, draft.where(*origin), "hub.uses: a policy, or 'reconcile' of the spoke", write
        )
        return {}
    return _reconcile(expansion, f"{stem}_reconcile", step, (ref,), port, name, (*origin, "reconcile"))


def _step(expansion: _Expansion, port: PortSpec, what: str, own: StepSpec, otherwise: str) -> StepSpec:
    """The policy's step for a kind of evidence, with what the spoke says laid over it."""
    policy = expansion.policy.get(port.kind, expansion.policy.get("*", {})).get(what, {})
    if own.uses is not None:
        return own
    merged = {**policy.get("with", {}), **own.with_}
    return StepSpec(uses=policy.get("uses", otherwise), with_=merged, in_={**policy.get("in", {}), **own.in_})


def _cohere(
    expansion: _Expansion, stem: str, ref: str, port: PortSpec, spoke: SpokeSpec, origin: tuple[str, ...]
) -> str:
    step = _step(expansion, port, "cohere", spoke.cohere, "none")
    if step.uses == "none":
        return ref
    path = (*origin, "cohere")
    callee = _step_callee(expansion, step, path)
    if callee is None:
        return ref
    given = [out for out in callee.outputs.values() if out.evidence]
    refs = _step_refs(expansion, callee, step, (ref,), port, origin[-1], path)
    node = NodeSpec(uses=str(step.uses), with_=step.with_, loop=expansion.hub.loop, levels=spoke.levels, in_=refs, of=origin[-1])  # fmt: skip
    expansion.add(f"{stem}_cohere", node, callee, *path)
    if not given:
        expansion.draft.say("VI222", f"{callee.id} gives no evidence", expansion.draft.where(*path))
        return ref
    return f"{stem}_cohere.{given[0].name}"


def _step_callee(expansion: _Expansion, step: StepSpec, path: tuple[str, ...]) -> Callee | None:
    draft = expansion.draft
    return find_callee(draft, str(step.uses), draft.where(*path, "uses"), lambda _: None)


def _step_refs(
    expansion: _Expansion,
    callee: Callee,
    step: StepSpec,
    evidence: tuple[str, ...],
    port: PortSpec | None,
    spoke: str,
    path: tuple[str, ...],
) -> Refs:
    """What a step's ports are bound to: the evidence to the first port that takes it, the rest by name."""
    takes = [
        spec
        for spec in callee.inputs.values()
        if spec.evidence and (port is None or reader_between(port, spec))
    ]
    if not takes:
        kinds = f"{port}" if port else "a list of evidence"
        found = f"{callee.id} takes no {kinds}"
        expansion.draft.say(
            "VI222", found, expansion.draft.where(*path), listed(f"{n}: {s}" for n, s in callee.inputs.items())
        )
        return {}
    own = {**step.in_}
    own.setdefault(takes[0].name, evidence if takes[0].many else evidence[0])
    return _bound(expansion, callee, own, set(), _other_outputs(expansion, spoke), path)


def _other_outputs(expansion: _Expansion, spoke: str) -> dict[str, str]:
    callee = expansion.callees.get(spoke)
    outputs = callee.outputs.values() if callee else ()
    return {port.name: f"{spoke}.{port.name}" for port in outputs if not port.evidence}


def _reconcile(
    expansion: _Expansion,
    node_name: str,
    step: StepSpec,
    evidence: tuple[str, ...],
    port: PortSpec | None,
    spoke: str,
    path: tuple[str, ...],
) -> Refs:
    callee = _step_callee(expansion, step, path)
    if callee is None:
        return {}
    refs = _step_refs(expansion, callee, step, evidence, port, spoke, path)
    levels = expansion.nodes[spoke].levels if spoke in expansion.nodes else None
    of = spoke if spoke in expansion.nodes else None
    node = NodeSpec(uses=str(step.uses), with_=step.with_, loop=expansion.hub.loop, levels=levels, in_=refs, of=of)  # fmt: skip
    expansion.add(node_name, node, callee, *path)
    return dict(_fields_of(expansion, node_name, callee))


def _fields_of(expansion: _Expansion, node: str, callee: Callee) -> Iterator[tuple[str, str]]:
    """The outputs of a reconciler that are fields of the map, or the confidence of the one field it gives."""
    stored = stored_fields(expansion.draft.catalog)
    given = [
        field
        for field, kind in stored.items()
        if field in callee.outputs and callee.outputs[field].kind == kind.name
    ]
    if not given:
        where = expansion.draft.where(*expansion.origins[node])
        expansion.draft.say(
            "VI222", f"{callee.id} gives no field of the map", where, "fields: " + listed(stored)
        )
    for field_name in given:
        yield field_name, f"{node}.{field_name}"
        own = f"{field_name}_confidence"
        confidence = own if own in callee.outputs else "confidence"
        if confidence in callee.outputs and (confidence == own or len(given) == 1):
            yield own, f"{node}.{confidence}"


def _commit(expansion: _Expansion, name: str, fields: Refs, spoke: str | None, origin: tuple[str, ...]) -> None:
    refs = {"map": f"{expansion.current}.map", **fields}
    node = NodeSpec(uses=COMMIT, loop=expansion.hub.loop, in_=refs, of=spoke)
    expansion.current = expansion.add(name, node, None, *origin)


def _reconcile_fields(expansion: _Expansion) -> None:
    """The fields that are reconciled once a sweep, from all their evidence together."""
    for field_name, step in expansion.hub.reconcile.items():
        path = ("hub", "reconcile", field_name)
        evidence = tuple(expansion.pending.get(field_name, ()))
        if evidence and step.uses is not None:
            name = f"{field_name}_reconcile"
            fields = _reconcile(expansion, name, step, evidence, None, "", path)
            _commit(expansion, f"map_{field_name}", fields, None, path)


def _check_reconcile(expansion: _Expansion) -> None:
    draft = expansion.draft
    for field_name, step in expansion.hub.reconcile.items():
        where = draft.where("hub", "reconcile", field_name, key=True)
        if field_name not in expansion.pending:
            has = "fields with evidence: " + listed(expansion.pending)
            draft.say("VI222", f"no spoke gives evidence on {field_name!r}", where, has)
        if step.uses is None:
            draft.say("VI105", "the key 'uses' is missing", where, "", "uses: plugin.module")


def _end(expansion: _Expansion) -> None:
    """The last commit is called ``map``; a hub whose spokes say nothing still has one."""
    last = expansion.current
    if last == "map_begin":
        _commit(expansion, MAP, {}, None, ("hub",))
        return
    nodes = {MAP if name == last else name: node for name, node in expansion.nodes.items()}
    expansion.origins[MAP] = expansion.origins.pop(last)
    expansion.nodes = nodes


def _plain(spec: GraphSpec, expansion: _Expansion) -> GraphSpec:
    nodes = {**spec.nodes, **expansion.nodes}
    return spec.model_copy(update={"hub": None, "nodes": nodes})
