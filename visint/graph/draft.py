"""What binding works on: the plain spec, where its parts stand in the file, and the problems found so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from visint.errors import GraphError, PluginError, Problem, Where
from visint.fields.kinds import FieldKind
from visint.graph.graph import INPUTS, Callee
from visint.graph.read import Places
from visint.graph.spec import GraphSpec, InputSpec
from visint.module import PortSpec
from visint.names import PortRef, did_you_mean, listed
from visint.registry import Catalog

__all__ = ["Draft"]

Origin = tuple[str, ...]


@dataclass(slots=True)
class Draft:
    """A graph on its way from spec to bound graph.

    ``calling`` are the graphs being bound around this one, itself last; ``fields`` what its map stores.
    ``origins`` says for a node that a hub was expanded into where in the file it comes from.
    """

    spec: GraphSpec
    catalog: Catalog
    places: Places
    calling: tuple[str, ...] = ()
    fields: Mapping[str, FieldKind] = field(default_factory=dict)
    origins: Mapping[str, Origin] = field(default_factory=dict)
    callees: dict[str, Callee] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def where(self, *path: str | int, key: bool = False) -> Where:
        """The place of a path of keys; a path into an expanded node leads to what it was expanded from."""
        if len(path) > 1 and path[0] == "nodes" and path[1] in self.origins:
            origin, rest = self.origins[str(path[1])], path[2:]
            if origin == ("hub",) and rest[:1] in (("in",), ("with",)):  # what the map begins with
                rest = ("start", *rest[1:])
            path = (*origin, *rest)
        return self.places.where(*path, key=key)

    def say(self, code: str, found: str, where: Where, choices: str = "", write: str = "") -> None:
        """Notes a problem; they are raised together at the end of a phase."""
        self.problems.append(Problem(code, found, where, choices, write))

    def raise_problems(self) -> None:
        """Ends a phase: raises everything noted so far, in the order of the file."""
        if self.problems:
            distinct = {(str(problem)): problem for problem in self.problems}
            in_order = sorted(distinct.values(), key=lambda p: (p.where.line, p.where.column))
            broken = all(problem.fault == "plugin" for problem in in_order)
            raise (PluginError if broken else GraphError)(in_order)

    def input_port(self, name: str) -> PortSpec:
        """A graph input, as the port it is to the nodes it feeds."""
        declared = InputSpec.parse(self.spec.inputs[name])
        kind = self.catalog.kind(declared.kind)
        return PortSpec(name, declared.kind, kind.array if kind else None, declared.optional, declared.many)

    def source(self, ref: str, where: Where) -> tuple[PortRef, PortSpec] | None:
        """The reference spelled by ``ref`` and the port it means; None, with a problem noted, if none."""
        parsed = PortRef.parse(ref)
        if parsed is None:
            self.say("VI202", f"{ref!r} is no reference; one is written node.port", where, self._nodes())
            return None
        if parsed.node == INPUTS:
            return self._from_input(parsed, where)
        if parsed.node not in self.spec.nodes:
            near = did_you_mean(parsed.node, [*self.spec.nodes, INPUTS])
            write = f"{near}.{parsed.port}" if near else ""
            self.say("VI202", f"there is no node {parsed.node!r}", where, self._nodes(), write)
            return None
        return self._from_node(parsed, where)

    def _from_input(self, ref: PortRef, where: Where) -> tuple[PortRef, PortSpec] | None:
        if ref.port in self.spec.inputs:
            return ref, self.input_port(ref.port)
        choices = "inputs: " + listed(f"{name}: {text}" for name, text in self.spec.inputs.items())
        near = did_you_mean(ref.port, self.spec.inputs)
        write = f"{INPUTS}.{near}" if near else ""
        self.say("VI202", f"there is no input {ref.port!r}", where, choices, write)
        return None

    def _from_node(self, ref: PortRef, where: Where) -> tuple[PortRef, PortSpec] | None:
        callee = self.callees.get(ref.node)
        if callee is None:  # its own problem is noted already
            return None
        if ref.port in callee.outputs:
            return ref, callee.outputs[ref.port]
        near = did_you_mean(ref.port, callee.outputs)
        only = next(iter(callee.outputs)) if len(callee.outputs) == 1 else None
        write = f"{ref.node}.{near or only}" if near or only else ""
        found = f"{ref.node!r} ({callee.id}) has no output {ref.port!r}"
        self.say("VI202", found, where, self.outputs_of(ref.node), write)
        return None

    def outputs_of(self, node: str) -> str:
        """The outputs of a node (or of ``inputs``) as the choices of a message."""
        if node == INPUTS:
            return "inputs: " + listed(f"{name}: {text}" for name, text in self.spec.inputs.items())
        callee = self.callees[node]
        ports = listed(f"{name}: {spec.kind}" for name, spec in callee.outputs.items())
        return f"outputs of {node!r} ({callee.id}): {ports}"

    def _nodes(self) -> str:
        return "nodes: " + listed([*self.spec.nodes, INPUTS])
