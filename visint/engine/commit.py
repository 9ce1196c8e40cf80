"""Keeping the map: how it begins, and how what spokes found is committed to it. Only the engine does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from visint.arrays import Array, read_only
from visint.engine.invoke import Invoke
from visint.engine.state import BLIND_GUESS, State
from visint.errors import ModuleError
from visint.fields import geometry
from visint.fields.camera import Camera
from visint.fields.evidence import DepthEvidence, DisparityEvidence, Evidence
from visint.fields.kinds import KINDS, FieldKind, down
from visint.fields.snapshot import MapSnapshot, Writer
from visint.graph.callees import BEGIN
from visint.graph.graph import Node
from visint.module import Context

__all__ = ["Fields", "map_call", "plane", "stored_kinds"]


class Fields(Mapping[str, Any]):
    """A snapshot as the outputs of a node: ports are fields, derived ones computed when read."""

    def __init__(self, snapshot: MapSnapshot) -> None:
        self.snapshot = snapshot

    def __getitem__(self, port: str) -> Any:
        return self.snapshot.read(port)

    def __iter__(self) -> Any:
        return iter(self.snapshot.values)

    def __len__(self) -> int:
        return len(self.snapshot.values)


def map_call(node: Node) -> Invoke:
    """What runs at a ``map.begin`` or ``map.commit`` node."""
    if node.callee.id == BEGIN:
        return lambda values, context, state: Fields(_begin(node, values, context, state))
    writer = node.of or node.name
    return lambda values, context, _: Fields(_commit(values, Writer(writer, context.level, context.turn)))


def plane(kind: str, camera: Camera) -> Array:
    """A fronto-parallel plane at the middle of the search range, as ``"Depth"`` or ``"Disparity"``, (H, W)."""
    middle = camera.middle_disparity
    middle = BLIND_GUESS * camera.width if middle is None else middle
    flat = np.full(camera.size, middle, np.float32)
    return read_only(flat if kind == "Disparity" else geometry.depth_from_disparity(flat, camera))


def stored_kinds(node: Node) -> dict[str, FieldKind]:
    """The kind of each field that the map of a ``map.begin`` node stores."""
    stored = [name for name in node.callee.outputs if f"{name}_confidence" in node.callee.outputs]
    specs = {name: node.callee.outputs[name] for name in stored}
    return {name: KINDS.get(spec.kind) or FieldKind(spec.kind, spec.array) for name, spec in specs.items()}


def _begin(node: Node, values: dict[str, Any], context: Context, state: State) -> MapSnapshot:
    camera = values["camera"] or state.camera_at(context.level)
    if camera is None:
        raise ModuleError.of("VI402", "a map needs an image among the graph's inputs, to know its size")
    last: MapSnapshot | None = values["map"]
    if last is None:
        return _started(node, values, camera, state.warm, context.level)
    return last if last.camera == camera else last.seen_by(camera)


def _started(
    node: Node, values: dict[str, Any], camera: Camera, warm: Mapping[str, Any], level: int
) -> MapSnapshot:
    """The map before anybody wrote into it: each field warm, from the graph's own start, or unknown."""
    kinds = stored_kinds(node)
    fields: dict[str, Any] = {}
    confidence: dict[str, Any] = {}
    for name, kind in kinds.items():
        sure = f"{name}_confidence"
        fields[name] = _warm(warm, name, kind, level, _start(name, kind, node, values, camera))
        confidence[name] = _warm(warm, sure, KINDS["Confidence"], level, values.get(sure))
        if confidence[name] is None and isinstance(fields[name], np.ndarray):
            confidence[name] = read_only(np.zeros(fields[name].shape[:2], np.float32))
    return MapSnapshot(camera, kinds, fields, confidence)


def _warm(warm: Mapping[str, Any], name: str, kind: FieldKind, level: int, otherwise: Any) -> Any:
    """A field of a warm start, brought down to a level."""
    if name not in warm:
        return otherwise
    value = warm[name]
    for _ in range(level):
        value = down(value, kind)
    return value


def _start(name: str, kind: FieldKind, node: Node, values: dict[str, Any], camera: Camera) -> Any:
    if values[name] is not None:
        return values[name]
    asked = dict(node.params).get(name, "plane" if name == "depth" else "none")
    if asked == "none":
        return None
    if asked == "plane":
        return plane(kind.name, camera)
    dtype = kind.array.dtype if kind.array else "float32"
    return read_only(np.full(camera.size, asked, dtype))


def _commit(values: dict[str, Any], writer: Writer) -> MapSnapshot:
    snapshot: MapSnapshot = values["map"]
    for name in snapshot.kinds:
        evidence, given = values.get(f"{name}_evidence"), values.get(name)
        if evidence is not None:
            snapshot = _replaced(snapshot, name, evidence, writer)
        elif given is not None:
            sure = values.get(f"{name}_confidence")
            snapshot = snapshot.with_field(name, _kept_where_unknown(snapshot, name, given), sure, writer)
    return snapshot


def _kept_where_unknown(snapshot: MapSnapshot, name: str, given: Any) -> Any:
    """What a reconciler leaves unknown stays as it was: the map never loses what it has."""
    before = snapshot.values[name]
    if before is None or not isinstance(given, np.ndarray) or given.dtype != np.float32:
        return given
    return np.where(np.isnan(given), before, given)


def _replaced(snapshot: MapSnapshot, name: str, evidence: Evidence, writer: Writer) -> MapSnapshot:
    """The field replaced wherever the evidence speaks: the built-in step ``replace``."""
    evidence = _as_field(evidence, snapshot.kinds[name], snapshot.camera)
    before, sure = snapshot.values[name], snapshot.confidence[name]
    speaks = evidence.reliability > 0
    if before is None:
        return snapshot.with_field(name, evidence.value, evidence.reliability, writer)
    wide = speaks.reshape(speaks.shape + (1,) * (evidence.value.ndim - 2))
    value = np.where(wide, evidence.value, before)
    trust = evidence.reliability if sure is None else np.where(speaks, evidence.reliability, sure)
    return snapshot.with_field(name, value, trust, writer)


def _as_field(evidence: Evidence, kind: FieldKind, camera: Camera) -> Evidence:
    if evidence.measures == kind.name:
        return evidence
    if isinstance(evidence, DisparityEvidence) and kind.name == "Depth":
        return geometry.depth_evidence(evidence, camera)
    if isinstance(evidence, DepthEvidence) and kind.name == "Disparity":
        return geometry.disparity_evidence(evidence, camera)
    raise ModuleError.of("VI402", f"{evidence.measures} evidence cannot replace {kind.name}")
