"""A hub on its way to plain nodes: what is written so far, which node is the map now, ports bound by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from visint.graph.callees import COMMIT, map_ports
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, MAP, Callee
from visint.graph.ports import reader_between
from visint.graph.spec import HubSpec, NodeSpec
from visint.module import PortSpec

__all__ = ["Evidence", "Expansion", "Path", "Refs"]

Path = tuple[str, ...]
Refs = dict[str, Any]


class Evidence(NamedTuple):
    """Evidence on its way into the map: the reference it is read by, and the port it came from."""

    ref: str
    port: PortSpec


@dataclass(slots=True)
class Expansion:
    """The plain graph as far as it is written.

    ``current`` is the node that is the map now; ``pending`` the evidence kept for the reconciler of a field;
    ``spoken_of`` the fields that any spoke gives evidence on.
    """

    draft: Draft
    hub: HubSpec
    policy: Mapping[str, Mapping[str, Any]]
    nodes: dict[str, NodeSpec] = field(default_factory=dict)
    origins: dict[str, Path] = field(default_factory=dict)
    callees: dict[str, Callee] = field(default_factory=dict)
    current: str = "map_begin"
    pending: dict[str, list[Evidence]] = field(default_factory=dict)
    spoken_of: dict[str, None] = field(default_factory=dict)

    def add(self, name: str, spec: NodeSpec, callee: Callee | None, origin: Path) -> str:
        """Writes a node; ``origin`` is the part of the hub that it stands for."""
        if name in self.draft.spec.nodes or name in self.nodes:
            taken = name in self.draft.spec.nodes
            found = f"the hub calls a node of its own {name!r}; that name is taken"
            place = ("nodes", name) if taken else origin[:3]
            self.draft.say("VI223", found, self.draft.where(*place, key=True), write=f"{place[-1]}_2: …")
        self.nodes[name] = spec
        self.origins[name] = origin
        if callee is not None:
            self.callees[name] = callee
        return name

    def field_of(self, port: PortSpec) -> str:
        """The field of the map that evidence on ``port`` is about; empty if none."""
        kind = self.draft.catalog.kind(port.kind)
        return kind.constrains if kind else ""

    def commit(self, name: str, fields: Refs, spoke: str | None, origin: Path) -> None:
        """Writes the node that enters ``fields`` into the map, which is the map from now on."""
        refs = {"map": f"{self.current}.map", **fields}
        node = NodeSpec(uses=COMMIT, loop=self.hub.loop, in_=refs, of=spoke)
        self.current = self.add(name, node, None, origin)

    def bound(self, callee: Callee, own: Refs, fed: set[str], other: Mapping[str, str], origin: Path) -> Refs:
        """Where each port comes from: ``own``, else the spoke's ``other`` outputs, the map, the graph's inputs.

        Ports in ``fed`` have a feedback edge and stay as they are.
        """
        refs: Refs = {port: self._now(ref) for port, ref in own.items()}
        for port, spec in callee.inputs.items():
            if port not in refs and port not in fed:
                ref = other.get(port) or self._by_name(port, spec, origin)
                if ref is not None:
                    refs[port] = ref
        return refs

    def _by_name(self, port: str, spec: PortSpec, origin: Path) -> str | None:
        fields = map_ports(self.draft)
        given = port in self.draft.spec.inputs
        if given and port in fields:
            found = f"{port!r} could be the map's field or the graph's input"
            write = f"in: {{{port}: {INPUTS}.{port}}}"
            where = self.draft.where(*origin)
            self.draft.say("VI220", found, where, f"{MAP}.{port}, {INPUTS}.{port}", write)
        if given:
            return f"{INPUTS}.{port}"
        fits = port in fields and port != "map" and reader_between(fields[port], spec)
        return f"{self.current}.{port}" if fits else None

    def _now(self, refs: Any) -> Any:
        """``map.field`` as of this point of the sweep."""
        if isinstance(refs, tuple):
            return tuple(self._now(ref) for ref in refs)
        node, dot, port = refs.partition(".")
        return f"{self.current}{dot}{port}" if node == MAP else refs
