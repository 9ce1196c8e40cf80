"""Attribution: which cue decided a field of the map at each pixel, and how much, followed commit by commit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from visint.arrays import Array, read_only
from visint.events import Event, NodeFinished
from visint.fields.evidence import Evidence
from visint.fields.kinds import KINDS
from visint.fields.pull import pull
from visint.fields.snapshot import MapSnapshot
from visint.graph.callees import BEGIN, COMMIT
from visint.graph.graph import INPUTS, Edge, Graph, Node

__all__ = ["Attribution", "Weights"]

Weights = Mapping[str, Mapping[str, Array]]
"""Field → cue → float32 (H, W) in [0, 1]; over all cues they sum to at most 1, the rest is the start's."""

_SHARE = KINDS["Confidence"]


class _Source(NamedTuple):
    """Evidence that enters a field: the cue it is of, the node and port it comes from; ``own`` information?"""

    cue: str
    node: str
    port: str
    own: bool


class _Entry(NamedTuple):
    """One field of a commit: the evidence it comes from, and the node that reconciled it (none: replaced)."""

    field: str
    sources: tuple[_Source, ...]
    reconciler: str


@dataclass(slots=True)
class _Moment:
    """The map after a node, and the weights that have led to it."""

    snapshot: MapSnapshot
    weights: dict[str, dict[str, Array]] = field(default_factory=dict)


class Attribution:
    """An observer that follows the map of a graph and keeps weights of the cues.

    At each commit the field moves towards what a cue said by a share w: all weights so far are multiplied by
    1 − w, and the cue's gets w more. What a reconciler says itself goes first: a plain port
    ``<field>_weights`` of Confidence, one array, or a list with one for each evidence that it was given: in
    the order of its ports as declared, then of each list.

    A spoke that reads nothing but the map has no weight: what it smooths stays theirs who brought it.
    It holds the last evidence of each spoke, and two snapshots a map.
    """

    def __init__(self, graph: Graph) -> None:
        nodes = graph.nodes.values()
        self._entries = {node.name: tuple(_entries(graph, node)) for node in nodes if node.callee.id == COMMIT}
        self._begins = {node.name: _source_of(node) for node in nodes if node.callee.id == BEGIN}
        self._before = {node: str(_source_of(graph.nodes[node])) for node in self._entries}
        self._heard = _heard(self._entries.values())
        self._said: dict[tuple[str, str], tuple[int, Any]] = {}
        self._moments: dict[str, _Moment] = {}

    def __call__(self, event: Event) -> None:
        """Takes note of evidence, and of what commits made of it."""
        if type(event) is not NodeFinished:
            return
        for port in self._heard.get(event.node, ()):
            self._said[event.node, port] = (event.level, event.outputs.get(port))
        if event.node in self._entries:
            self._committed(event)
        elif event.node in self._begins:
            self._begun(event)

    @property
    def weights(self) -> Weights:
        """The weights at the end of the run, fields without any left out."""
        found: dict[str, dict[str, Array]] = {}
        for moment in self._moments.values():
            found |= moment.weights
        return {name: {cue: read_only(one) for cue, one in each.items()} for name, each in found.items()}

    def _begun(self, event: NodeFinished) -> None:
        snapshot: MapSnapshot = event.outputs["map"]
        last = self._moments.pop(str(self._begins[event.node]), None)
        moment = _Moment(snapshot)
        if last is not None and snapshot.writers:  # else the map has started anew
            size = snapshot.camera.size
            moment.weights = {
                name: {cue: _fitted(one, size) for cue, one in each.items()}
                for name, each in last.weights.items()
            }
        self._moments[event.node] = moment

    def _committed(self, event: NodeFinished) -> None:
        before = self._moments.pop(self._before[event.node], None)
        if before is None:
            return
        after = _Moment(event.outputs["map"], before.weights)
        for entry in self._entries[event.node]:
            self._enter(entry, before.snapshot, after, event.level)
        self._moments[event.node] = after

    def _enter(self, entry: _Entry, before: MapSnapshot, after: _Moment, level: int) -> None:
        given = [(source, one) for source in entry.sources if (one := self._now(source, level)) is not None]
        told = self._told(entry, len(given), level)
        if told is None:
            given = [(source, one) for source, one in given if source.own]
            told = _at_most_all([pull(before, after.snapshot, entry.field, one) for _, one in given])
        counted = [(source.cue, share) for (source, _), share in zip(given, told, strict=True) if source.own]
        if counted:
            weights = after.weights.setdefault(entry.field, {})
            left = 1 - np.add.reduce([share for _, share in counted])
            for cue in weights:
                weights[cue] = weights[cue] * left
            for cue, share in counted:
                weights[cue] = weights[cue] + share if cue in weights else share

    def _now(self, source: _Source, level: int) -> Evidence | None:
        at, value = self._said.get((source.node, source.port), (-1, None))
        return value if at == level and isinstance(value, Evidence) else None

    def _told(self, entry: _Entry, count: int, level: int) -> list[Array] | None:
        """The weights that the reconciler gives, if it gives as many as there is evidence."""
        at, value = self._said.get((entry.reconciler, f"{entry.field}_weights"), (-1, None))
        if at != level or value is None:
            return None
        shares = list(value) if isinstance(value, tuple) else [value]
        return (
            _at_most_all([np.clip(np.nan_to_num(one), 0, 1) for one in shares])
            if len(shares) == count
            else None
        )


def _source_of(node: Node) -> str | None:
    """The node that a map comes from: through ``map``, by an edge or by feedback."""
    if "map" in node.feedback:
        return node.feedback["map"].edge.source.node
    edge = node.ins.get("map")
    return edge.source.node if isinstance(edge, Edge) else None


def _brings_its_own(graph: Graph, name: str) -> bool:
    """Whether a node knows anything but the map: an array among the graph's inputs, or a source, feeds it.

    What only reads the map and smooths it brings nothing: what it passes on stays theirs who brought it.
    """
    seen, open_ = {name}, [name]
    while open_:
        node = graph.nodes[open_.pop()]
        edges = [*(edge for _, edge in node.edges()), *(fed.edge for fed in node.feedback.values())]
        if not edges:
            return True
        for edge in edges:
            source = edge.source.node
            if source == INPUTS and edge.kind.array is not None:
                return True
            if source in graph.nodes and source not in seen and not _is_map(graph.nodes[source]):
                seen.add(source)
                open_.append(source)
    return False


def _is_map(node: Node) -> bool:
    return node.callee.id in (BEGIN, COMMIT)


def _entries(graph: Graph, commit: Node) -> Iterator[_Entry]:
    for port, edge in commit.edges():
        if port.endswith("_evidence"):
            yield _Entry(port.removesuffix("_evidence"), (_source(graph, commit, edge),), "")
        elif port != "map" and not port.endswith("_confidence"):
            reconciler = graph.nodes.get(edge.source.node)
            if reconciler is not None:
                sources = tuple(_source(graph, commit, one) for one in _given(reconciler))
                yield _Entry(port, sources, reconciler.name)


def _given(reconciler: Node) -> list[Edge]:
    """The edges that bring a reconciler evidence, in the order of its ports as declared, then of each list."""
    edges = list(reconciler.edges())
    ports = [name for name, port in reconciler.callee.inputs.items() if port.evidence]
    return [edge for port in ports for name, edge in edges if name == port]


def _source(graph: Graph, commit: Node, edge: Edge) -> _Source:
    """Where evidence comes from, and of which cue: that of the commit, of the node, or the node itself."""
    node = graph.nodes.get(edge.source.node)
    cue = commit.of or (node.of if node else None) or edge.source.node
    own = node is None or _brings_its_own(graph, node.name)
    return _Source(cue, edge.source.node, edge.source.port, own)


def _heard(entries: Any) -> dict[str, tuple[str, ...]]:
    """The ports to be remembered, by node."""
    ports: dict[str, dict[str, None]] = {}
    for entry in (entry for some in entries for entry in some):
        for source in entry.sources:
            ports.setdefault(source.node, {})[source.port] = None
        if entry.reconciler:
            ports.setdefault(entry.reconciler, {})[f"{entry.field}_weights"] = None
    return {node: tuple(some) for node, some in ports.items()}


def _at_most_all(shares: list[Array]) -> list[Array]:
    """Shares that together are at most 1 at every pixel."""
    if len(shares) < 2:
        return shares
    total = np.maximum(np.add.reduce(shares), 1)
    return [np.asarray(share / total, dtype=np.float32) for share in shares]


def _fitted(share: Array, size: tuple[int, int]) -> Array:
    """A map of shares at another level, of ``size`` (rows, columns)."""
    while share.shape[0] > size[0] or share.shape[1] > size[1]:
        share = _SHARE.downward(share)
    return share if share.shape == size else np.clip(_SHARE.upward(share, size), 0, 1)
