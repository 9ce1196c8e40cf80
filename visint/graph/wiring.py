"""Wiring one node: its ports joined to what feeds them, and what to say where that cannot be."""

from __future__ import annotations

from collections.abc import Iterator

from visint.errors import Where
from visint.fields.kinds import KINDS, FieldKind
from visint.graph.callees import BEGIN, COMMIT
from visint.graph.draft import Draft
from visint.graph.graph import INPUTS, Callee, Edge, Feedback
from visint.graph.ports import reader_between
from visint.graph.spec import FeedbackSpec, NodeSpec
from visint.graph.write import as_written
from visint.module import PortSpec
from visint.names import PortRef, did_you_mean, listed

__all__ = ["Wiring", "edge_as_it_is"]

_MAP_KIND = FieldKind("Map")
_TOO_MANY = 50
"""With so many problems noted nobody reads on: no more is searched for what would fit."""


def edge_as_it_is(draft: Draft, ref: str, where: Where) -> Edge | None:
    """The edge from ``ref`` for who takes any kind: the graph's outputs, and the ends of loops."""
    found = draft.source(ref, where)
    return None if found is None else Edge(found[0], "plain", _kind(draft, found[1]))


def _kind(draft: Draft, spec: PortSpec) -> FieldKind:
    if spec.kind == "Map":
        return _MAP_KIND
    return draft.catalog.kind(spec.kind) or FieldKind(spec.kind, spec.array)


class Wiring:
    """The in-edges and feedback edges of one node; problems are noted in the draft."""

    def __init__(self, draft: Draft, name: str, node: NodeSpec, callee: Callee) -> None:
        self._draft = draft
        self._name = name
        self._node = node
        self._callee = callee
        self._meant: set[str] = set()  # the ports that a misspelled one was to be

    def ins(self) -> dict[str, Edge | tuple[Edge, ...]]:
        """The edges of ``in``, by port; several for a list."""
        ins: dict[str, Edge | tuple[Edge, ...]] = {}
        for port, refs in self._node.in_.items():
            target = self._target("in", port, as_written(refs))
            if target is None:
                continue
            where = self._draft.where("nodes", self._name, "in", port)
            if isinstance(refs, str):
                edge = self._edge(refs, where, target)
                if edge is not None:
                    ins[port] = edge
            elif target.many:
                ins[port] = tuple(self._members(refs, target))
            else:
                write = f"{port}: {refs[0] if refs else self._best(target)}"
                found = f"{port!r} of {self._callee.id} takes one value, not a list"
                self._draft.say("VI203", found, where, write=write)
        return ins

    def _members(self, refs: tuple[str, ...], target: PortSpec) -> Iterator[Edge]:
        for i, ref in enumerate(refs):
            edge = self._edge(
                ref, self._draft.where("nodes", self._name, "in", target.name, i), target, in_list=True
            )
            if edge is not None:
                yield edge

    def feedbacks(self) -> Iterator[tuple[str, Feedback]]:
        """The edges of ``feedback``, by port."""
        for port, spec in self._node.feedback.items():
            path = ("nodes", self._name, "feedback", port)
            given = spec.model_dump(by_alias=True, exclude_defaults=True)
            target = self._target("feedback", port, as_written(given))
            if target is None:
                continue
            if port in self._node.in_:
                found = f"{port!r} is fed twice, by 'in' and by 'feedback'"
                write = f"feedback: {{{port}: …}}   (and no {port!r} in 'in')"
                self._draft.say("VI212", found, self._draft.where(*path, key=True), write=write)
            edge = self._edge(spec.from_, self._draft.where(*path, "from"), target)
            loop = self._common_loop(spec, path)
            if edge is not None and loop is not None:
                yield port, Feedback(edge, loop, self._start(spec, target, path), spec.restart)

    def check_fed(self) -> None:
        """Notes every required port that nothing feeds."""
        for port, spec in self._callee.inputs.items():
            fed = port in self._node.in_ or port in self._node.feedback or port in self._meant
            if spec.optional or fed or self._has_default(port):
                continue
            found = f"{self._callee.id} needs {port!r} ({spec}), and nothing feeds it"
            choices = "what would fit: " + listed(self._fitting(spec))
            where = self._draft.where("nodes", self._name, "in", port)
            self._draft.say("VI204", found, where, choices, f"in: {{{port}: {self._best(spec)}}}")

    def _has_default(self, port: str) -> bool:
        module = self._callee.module
        return module is not None and not module.Inputs.model_fields[port].is_required()

    def _target(self, key: str, port: str, given: str) -> PortSpec | None:
        inputs = self._callee.inputs
        if port in inputs:
            return inputs[port]
        free = [one for one in inputs if one not in self._node.in_ and one not in self._node.feedback]
        near = did_you_mean(port, free) or did_you_mean(port, inputs) or next(iter(free), "")
        self._meant.add(near)
        found = f"{self._callee.id} has no input {port!r}"
        choices = f"inputs of {self._name!r} ({self._callee.id}): " + listed(
            f"{name}: {spec}" for name, spec in inputs.items()
        )
        where = self._draft.where("nodes", self._name, key, port, key=True)
        write = f"{near}: {given}" if near else f"(nothing: leave {port!r} out)"
        self._draft.say("VI206", found, where, choices, write)
        return None

    def _edge(self, ref: str, where: Where, target: PortSpec, *, in_list: bool = False) -> Edge | None:
        """The edge from ``ref``, read as ``target`` wants it; a member of a list where told so."""
        found = self._draft.source(ref, where)
        if found is None:
            return None
        source, spec = found
        reader = reader_between(spec, target)
        if reader is None or spec.many != (target.many and not in_list):
            self._misfit(source, spec, target, where)
            return None
        if spec.optional and not (target.optional or target.many):
            said = f"{target.name!r} must be fed, but {ref!r} is optional and may be absent"
            sure = [one for one in self._fitting(target, sure=True) if one != ref]
            write = self._always(source, spec) or f"{target.name}: {next(iter(sure), 'node.port')}"
            self._draft.say("VI204", said, where, "what would fit: " + listed(sure), write)
        return Edge(source, reader, KINDS["Image"] if reader == "luminance" else _kind(self._draft, spec))

    def _always(self, source: PortRef, spec: PortSpec) -> str:
        """How a source that may be absent would always be there: an input, or a field of the map."""
        if source.node == INPUTS:
            return f"{source.port}: {spec.kind}   (among the graph's inputs, without '?')"
        if self._draft.spec.nodes[source.node].uses not in (BEGIN, COMMIT):
            return ""
        field = source.port.removesuffix("_confidence")
        if field not in self._draft.fields:  # a derived one
            field = "boundaries" if field == "regions" else "depth"
        return f"start: {{{field}: {'plane' if field == 'depth' else 0}}}   (on the hub)"

    def _misfit(self, source: PortRef, spec: PortSpec, target: PortSpec, where: Where) -> None:
        found = f"wants {target}; {str(source)!r} is {spec}"
        fits_singly = reader_between(spec, target) is not None and target.many and not spec.many
        right = f"[{source}]" if fits_singly else self._best(target, source.node)
        key = where.path.rpartition(".")[2]
        write = right if key.isdigit() else f"{key}: {right}"
        self._draft.say("VI203", found, where, self._draft.outputs_of(source.node), write)

    def _best(self, target: PortSpec, node: str = "") -> str:
        """The likeliest source for ``target``, one of ``node`` before others; in words if there is none."""
        fitting = self._fitting(target)
        by_node = [ref for ref in fitting if ref.startswith(f"{node}.")]
        by_name = [ref for ref in fitting if ref.endswith(f".{target.name}")]
        kind = f"{target.kind} evidence" if target.evidence else target.kind or "evidence"
        return next(iter([*by_node, *by_name, *fitting]), f"node.port   (of a node that gives {kind})")

    def _fitting(self, target: PortSpec, *, sure: bool = False) -> list[str]:
        """What may feed ``target``: outputs of nodes that this one does not feed itself, and graph inputs.

        ``sure`` leaves out what may be absent.
        """
        draft = self._draft
        if len(draft.problems) > _TOO_MANY:
            return []
        after = self._downstream()
        ports = [
            (f"{name}.{port}", spec)
            for name, callee in draft.callees.items()
            if name not in after
            for port, spec in callee.outputs.items()
        ]
        ports += [(f"{INPUTS}.{name}", draft.input_port(name)) for name in draft.spec.inputs]
        return [
            ref
            for ref, spec in ports
            if spec.many == target.many and reader_between(spec, target) and not (sure and spec.optional)
        ]

    def _downstream(self) -> set[str]:
        """The node itself and all that it feeds, directly or not."""
        after, waiting = {self._name}, [self._name]
        while waiting:
            last = waiting.pop()
            for name, node in self._draft.spec.nodes.items():
                if name not in after and last in _sources(node):
                    after.add(name)
                    waiting.append(name)
        return after

    def _common_loop(self, spec: FeedbackSpec, path: tuple[str, ...]) -> str | None:
        """The innermost loop that holds both ends of a feedback edge."""
        draft = self._draft
        source = draft.spec.nodes.get(spec.from_.partition(".")[0])
        if source is None and spec.from_.partition(".")[0] != INPUTS:  # its own problem is noted already
            return None
        ours, theirs = self._chain(self._node.loop), self._chain(source.loop if source else None)
        common = [loop for loop in ours if loop in theirs]
        if common:
            return common[-1]
        if {self._node.loop, source.loop if source else None} - {None} - {*draft.spec.loops}:
            return None  # a loop that there is not: told by itself
        found = f"{self._name!r} and {spec.from_!r} lie in no common loop, so there is no turn before"
        loop = self._node.loop or (source.loop if source else None) or next(iter(draft.spec.loops), "")
        ends = dict.fromkeys([self._name, spec.from_.partition(".")[0]])
        both = "(on " + " and on ".join(map(repr, ends)) + ")"
        write = (
            f"loop: {loop}   {both}" if loop else f"loops: {{sweeps: {{times: 20}}}}   and loop: sweeps {both}"
        )
        if source is None:
            write = f"in: {{{path[-1]}: {spec.from_}}}"
        draft.say("VI214", found, draft.where(*path), "loops: " + listed(draft.spec.loops), write)
        return None

    def _chain(self, loop: str | None) -> list[str]:
        loops, chain = self._draft.spec.loops, list[str]()
        while loop is not None and loop in loops and loop not in chain:
            chain.append(loop)
            loop = loops[loop].inside
        return chain[::-1]

    def _start(self, spec: FeedbackSpec, target: PortSpec, path: tuple[str, ...]) -> float | str | Edge | None:
        if isinstance(spec.start, str) and "." not in spec.start and spec.start != "plane":
            near = did_you_mean(spec.start, ["plane", "none"]) or "0"
            choices = "starts: none, a number, plane, or node.port from outside the loop"
            where = self._draft.where(*path, "start")
            self._draft.say("VI215", f"{spec.start[:70]!r} is no start", where, choices, f"start: {near}")
            return None
        if isinstance(spec.start, str) and spec.start != "plane":
            return self._edge(spec.start, self._draft.where(*path, "start"), target)
        return spec.start


def _sources(node: NodeSpec) -> set[str]:
    refs = [ref for given in node.in_.values() for ref in ((given,) if isinstance(given, str) else given)]
    return {ref.partition(".")[0] for ref in refs}
