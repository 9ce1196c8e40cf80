"""What binding works on: the plain spec, where its parts stand in the file, and the problems found so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from visint.errors import GraphError, PluginError, Problem, Where
from visint.fields.kinds import FieldKind
from visint.graph.graph import INPUTS, MAP, Callee
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
            found = f"{ref[:70]!r} is no reference; one is written node.port"
            self._say_lost(found, where, self._nodes(), self._meant(ref))
            return None
        if parsed.node == INPUTS:
            return self._from_input(parsed, where)
        if parsed.node not in self.spec.nodes:
            near = did_you_mean(parsed.node, [*self.spec.nodes, INPUTS])
            write = self._port_near(near, parsed.port) if near else self._giving(parsed.port)
            found = f"there is no node {parsed.node!r}" + " without a hub" * (parsed.node == MAP)
            self._say_lost(found, where, self._nodes(), write)
            return None
        return self._from_node(parsed, where)

    def _say_lost(self, found: str, where: Where, choices: str, ref: str) -> None:
        """Notes a reference that points nowhere; ``ref`` is what was meant, if anything is near."""
        key = where.path.rpartition(".")[2]
        self.say("VI202", found, where, choices, ref if key.isdigit() else f"{key}: {ref}")

    def _meant(self, text: str) -> str:
        """What a text that is no reference was meant to be: an input, or an output of a node."""
        if text in self.spec.inputs:
            return f"{INPUTS}.{text}"
        near = did_you_mean(text, [*self.spec.nodes, *self.spec.inputs])
        if near in self.spec.inputs:
            return f"{INPUTS}.{near}"
        return self._port_near(near, "") if near else self._giving(text)

    def _port_near(self, node: str, port: str) -> str:
        """The output of ``node`` that ``port`` most likely means; its first one if none is near."""
        callee = self.callees.get(node)
        known = self.spec.inputs if node == INPUTS else callee.outputs if callee else ()
        return f"{node}.{did_you_mean(port, known) or next(iter(known), 'port')}"

    def _giving(self, port: str) -> str:
        """A reference to an input, or an output, whose name is (nearly) ``port``."""
        by_port = {out: f"{node}.{out}" for node, callee in self.callees.items() for out in callee.outputs}
        by_port |= {name: f"{INPUTS}.{name}" for name in self.spec.inputs}
        return by_port.get(did_you_mean(port, by_port) or "", "node.port")

    def _from_input(self, ref: PortRef, where: Where) -> tuple[PortRef, PortSpec] | None:
        if ref.port in self.spec.inputs:
            return ref, self.input_port(ref.port)
        near = did_you_mean(ref.port, self.spec.inputs)
        write = f"{INPUTS}.{near}" if near else self._giving(ref.port)
        if write == "node.port":
            write = f"{INPUTS}.{ref.port}   (with inputs: {{{ref.port}: Image}})"
        self._say_lost(f"the graph has no input {ref.port!r}", where, self.outputs_of(INPUTS), write)
        return None

    def _from_node(self, ref: PortRef, where: Where) -> tuple[PortRef, PortSpec] | None:
        callee = self.callees.get(ref.node)
        if callee is None:  # its own problem is noted already
            return None
        if ref.port in callee.outputs:
            return ref, callee.outputs[ref.port]
        found = f"{ref.node!r} ({callee.id}) has no output {ref.port!r}"
        self._say_lost(found, where, self.outputs_of(ref.node), self._port_near(ref.node, ref.port))
        return None

    def outputs_of(self, node: str) -> str:
        """The outputs of a node (or of ``inputs``) as the choices of a message."""
        if node == INPUTS:
            inputs = ((name, InputSpec.parse(text)) for name, text in self.spec.inputs.items())
            return "inputs: " + listed(f"{name}: {declared}" for name, declared in inputs)
        callee = self.callees[node]
        ports = listed(f"{name}: {spec.kind}" for name, spec in callee.outputs.items())
        return f"outputs of {node!r} ({callee.id}): {ports}"

    def _nodes(self) -> str:
        """The nodes to choose from: those of the file, and the map where there is one."""
        return "nodes: " + listed([*(name for name in self.spec.nodes if not self._is_inner(name)), INPUTS])

    def _is_inner(self, node: str) -> bool:
        """Whether a node is one that only the expansion of a hub has."""
        return (
            node in self.origins and self.spec.nodes[node].uses in ("map.begin", "map.commit") and node != MAP
        )
