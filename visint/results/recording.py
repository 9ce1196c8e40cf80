"""A run as a recording for the Rerun viewer: every map of every level and turn on a timeline."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from visint import io
from visint.arrays import Array
from visint.errors import UsageError
from visint.events import Event, Measured, NodeFinished, TurnFinished, Warned
from visint.fields.evidence import Evidence
from visint.fields.snapshot import MapSnapshot
from visint.graph.graph import Graph
from visint.results.report.embed import reduced
from visint.results.report.maps import Map, is_map, picture

__all__ = ["Recording"]

_SIDE = 640
"""The longest side of a recorded picture in pixels."""


class Recording:
    """Give it to a run as an observer; afterwards :meth:`data` is the content of an ``.rrd`` file.

    The timeline ``step`` counts the calls of modules; ``level`` and ``turn`` are timelines too. Recorded are

    * each map a node gives, as a picture at ``NODE/PORT`` (evidence as ``value``, ``sigma``, ``reliability``);
    * each state of the intrinsic map, as pictures at ``NODE/FIELD`` and as depth before a camera at
      ``world/NODE/depth``, which the viewer shows in three dimensions;
    * the relative change of each turn at ``change/LOOP``, numbers of modules at ``measures/NODE/NAME``,
      warnings as text at ``warnings``.

    Raises
    ------
    UsageError
        VI701 if the extra ``rerun`` is not installed.
    """

    def __init__(self, graph: Graph) -> None:
        self._rerun = _sdk()
        self._graph = graph
        self._stream = self._rerun.RecordingStream(f"visint {graph.name}")
        self._written = self._stream.binary_stream()
        self._step = 0

    def __call__(self, event: Event) -> None:
        """Records maps, changes, numbers and warnings; nothing of it is kept by reference."""
        if isinstance(event, NodeFinished):
            self._step += 1
            self._at(event.level, event.turn)
            self._node(event)
        elif isinstance(event, TurnFinished):
            self._at(event.level, event.turn)
            if event.change is not None and np.isfinite(event.change):
                self._log(f"change/{event.loop}", self._rerun.Scalars(event.change))
        elif isinstance(event, Measured):
            self._at(event.level, event.turn)
            self._log(f"measures/{event.node}/{event.name}", self._rerun.Scalars(event.value))
        elif isinstance(event, Warned):
            self._at(event.level, event.turn)
            self._log("warnings", self._rerun.TextLog(f"{event.node}: {event.text} ({event.code})"))

    def data(self) -> bytes:
        """The recording so far, as the bytes of an ``.rrd`` file."""
        return bytes(self._written.read() or b"")

    def _at(self, level: int, turn: int) -> None:
        for timeline, value in (("step", self._step), ("level", level), ("turn", turn)):
            self._stream.set_time(timeline, sequence=value)

    def _log(self, entity: str, what: Any) -> None:
        self._stream.log(entity, what)

    def _node(self, event: NodeFinished) -> None:
        snapshot = getattr(event.outputs, "snapshot", None)
        if isinstance(snapshot, MapSnapshot):
            self._world(event.node, snapshot)
            named = list(_fields(snapshot))
        else:
            named = [
                one for port, value in event.outputs.items() for one in self._maps(event.node, port, value)
            ]
        for name, kind, value in named:
            if is_map(value):
                self._picture(f"{event.node}/{name}", kind, value)

    def _maps(self, node: str, port: str, value: Any) -> Iterator[tuple[str, str, Any]]:
        """(name, kind, array) of what an output port holds."""
        known = self._graph.nodes.get(node)
        spec = known.callee.outputs.get(port) if known else None
        if isinstance(value, Evidence):
            yield f"{port}/value", value.measures, value.value
            yield f"{port}/sigma", "Sigma", value.sigma
            yield f"{port}/reliability", "Confidence", value.reliability
        else:
            yield port, spec.kind if spec else "", value

    def _picture(self, entity: str, kind: str, value: Array) -> None:
        shown = reduced(np.ascontiguousarray(picture(Map(entity, kind, value))[..., :3]), _SIDE)
        image = self._rerun.EncodedImage(contents=io.encode_png(shown), media_type="image/png")
        self._log(entity, image)

    def _world(self, node: str, snapshot: MapSnapshot) -> None:
        depth, camera = snapshot.values.get("depth"), snapshot.camera
        if depth is None:
            return
        size = {"width": camera.width, "height": camera.height}
        centre = [
            camera.cx + 0.5,
            camera.cy + 0.5,
        ]  # its pixels have their corner at integers, ours their centre
        pinhole = self._rerun.Pinhole(focal_length=camera.focal_length, principal_point=centre, **size)
        self._log(f"world/{node}", pinhole)
        self._log(f"world/{node}/depth", self._rerun.DepthImage(np.nan_to_num(depth), meter=1.0))


def _fields(snapshot: MapSnapshot) -> Iterator[tuple[str, str, Any]]:
    for name, value in snapshot.values.items():
        yield name, snapshot.kinds[name].name, value
        yield f"{name}_confidence", "Confidence", snapshot.confidence.get(name)


def _sdk() -> Any:
    try:
        return importlib.import_module("rerun")
    except ImportError as error:
        found = f"a recording needs the extra 'rerun', which cannot be imported here: {error}"
        raise UsageError.of("VI701", found, write="pip install 'visint[rerun]'") from None
