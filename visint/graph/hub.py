"""Spelling out a hub: spokes and the steps of their evidence become plain nodes around the engine's map.

The map begins a sweep as ``map_begin``; each spoke's fields are committed by a node of their own
(``map_<spoke>``), and the last commit is called ``map``, so that ``map.depth`` reads the same before and after.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from visint.graph.callees import BEGIN, find_callee, plugins_named, stored_fields
from visint.graph.draft import Draft
from visint.graph.entry import enter, reconcile_fields
from visint.graph.expansion import Expansion, Refs
from visint.graph.graph import INPUTS, MAP
from visint.graph.rewire import rewired
from visint.graph.spec import FeedbackSpec, HubSpec, NodeSpec, SpokeSpec
from visint.module import PortSpec
from visint.names import did_you_mean, is_name, listed

__all__ = ["expand"]


def expand(draft: Draft) -> None:
    """Replaces the hub of ``draft.spec`` by plain nodes; problems are noted in the draft."""
    hub = draft.spec.hub
    assert hub is not None
    _check_order(draft, hub)
    policy = _policy(draft, hub)
    if any(name not in hub.spokes for name in hub.order) or len(set(hub.order)) < len(hub.order):
        return
    draft.fields = stored_fields(draft.catalog, plugins_named(draft.spec) | _plugins_of(policy))
    expansion = Expansion(draft, hub, policy)
    _begin(expansion)
    for name in hub.order:
        _spoke(expansion, name, hub.spokes[name])
    reconcile_fields(expansion)
    _end(expansion)
    draft.spec = draft.spec.model_copy(update={"hub": None, "nodes": {**draft.spec.nodes, **expansion.nodes}})
    draft.origins = expansion.origins


def _check_order(draft: Draft, hub: HubSpec) -> None:
    for index, name in enumerate(hub.order):
        where = draft.where("hub", "order", index)
        rest = [one for i, one in enumerate(hub.order) if i != index]
        if name not in hub.spokes:
            near = did_you_mean(name, set(hub.spokes) - set(hub.order))
            right = [near if one == name else one for one in hub.order] if near else rest
            choices = "spokes: " + listed(hub.spokes)
            draft.say("VI221", f"there is no spoke {name[:70]!r}", where, choices, _order(right))
        elif name in hub.order[:index]:
            found = f"the spoke {name!r} stands twice in the order"
            draft.say("VI212", found, where, write=_order([*dict.fromkeys(hub.order)]))
    for name in hub.spokes:
        meant = [did_you_mean(one, [name]) for one in hub.order if one not in hub.spokes]
        if name not in hub.order and name not in meant:
            where = draft.where("hub", "spokes", name, key=True)
            found = f"the spoke {name!r} is missing from 'order'"
            draft.say("VI221", found, where, write=_order([*hub.order, name]))


def _order(names: list[str]) -> str:
    return f"order: [{listed(names, none='')}]"


def _policy(draft: Draft, hub: HubSpec) -> Mapping[str, Mapping[str, Any]]:
    if hub.uses is None:
        return {}
    plugin, _, name = hub.uses.partition(".")
    where = draft.where("hub", "uses")
    if plugin not in draft.catalog.plugin_names:
        near = did_you_mean(plugin, draft.catalog.plugin_names)
        write = (
            f"uses: {near}.{name}" if near and is_name(name) else "pip install …   (the plugin that brings it)"
        )
        choices = "plugins: " + listed(draft.catalog.plugin_names)
        draft.say("VI201", f"no plugin is named {plugin[:70]!r}", where, choices, write)
        return {}
    found = draft.catalog.policy(hub.uses)
    if found is None:
        known = draft.catalog.plugin(plugin).policies
        near = did_you_mean(name, known) or next(iter(known), None)
        choices = f"policies of {plugin!r}: " + listed(f"{plugin}.{one}" for one in known)
        write = f"uses: {plugin}.{near}" if near else ""
        draft.say("VI201", f"{plugin!r} has no hub policy {name[:70]!r}", where, choices, write)
    return found or {}


def _plugins_of(policy: Mapping[str, Mapping[str, Any]]) -> set[str]:
    steps = [step for kind in policy.values() for step in kind.values()]
    return {str(step.get("uses", "")).partition(".")[0] for step in steps}


def _begin(expansion: Expansion) -> None:
    draft, hub = expansion.draft, expansion.hub
    refs: Refs = {}
    starts: dict[str, Any] = {}
    for name, start in hub.start.items():
        if isinstance(start, str) and "." in start:
            refs[name] = start
        else:
            starts[name] = "none" if start is None else start
    camera = _input_of_kind(draft, "Camera")
    if camera is not None:
        refs["camera"] = camera
    feedback = {"map": FeedbackSpec(from_=f"{MAP}.map")} if hub.loop else {}
    node = NodeSpec(uses=BEGIN, with_=starts, loop=hub.loop, in_=refs, feedback=feedback)
    expansion.add("map_begin", node, None, ("hub",))


def _input_of_kind(draft: Draft, kind: str) -> str | None:
    found = [name for name in draft.spec.inputs if draft.input_port(name).kind == kind]
    return f"{INPUTS}.{found[0]}" if len(found) == 1 else None


def _spoke(expansion: Expansion, name: str, spoke: SpokeSpec) -> None:
    draft, hub = expansion.draft, expansion.hub
    origin = ("hub", "spokes", name)
    callee = find_callee(draft, spoke.uses, draft.where(*origin, "uses"))
    if callee is None:
        return
    node = NodeSpec(
        uses=spoke.uses,
        with_=spoke.with_,
        loop=hub.loop,
        levels=spoke.levels,
        at=spoke.at,
        in_=expansion.bound(callee, spoke.in_, {*spoke.feedback}, {}, origin),
        feedback=spoke.feedback,
        of=name,
    )
    expansion.add(name, node, callee, origin)
    _enter_all(expansion, name, spoke, [port for port in callee.outputs.values() if port.evidence])


def _enter_all(expansion: Expansion, name: str, spoke: SpokeSpec, evidence: list[PortSpec]) -> None:
    """All evidence of a spoke in one commit; a second word on the same field sees the map after the first."""
    origin = ("hub", "spokes", name)
    fields: Refs = {}
    said: set[str] = set()
    for port in evidence:
        stem = name if len(evidence) == 1 else f"{name}_{port.name}"
        about = expansion.field_of(port)
        if about in said and fields:
            expansion.commit(f"map_{stem}", fields, name, origin)
            fields, said = {}, set()
        fields |= enter(expansion, name, spoke, port, stem)
        said.add(about)
    if fields:
        expansion.commit(f"map_{name}", fields, name, origin)


def _end(expansion: Expansion) -> None:
    """The last commit is called ``map``; a hub whose spokes say nothing still has one."""
    last = expansion.current
    if last == "map_begin":
        expansion.commit(MAP, {}, None, ("hub",))
        return
    renamed = {last: MAP}
    expansion.nodes = {
        renamed.get(name, name): rewired(node, renamed) for name, node in expansion.nodes.items()
    }
    expansion.origins[MAP] = expansion.origins.pop(last)
