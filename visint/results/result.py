"""The result of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from visint.arrays import Array, read_only
from visint.fields.camera import Camera
from visint.fields.evidence import Evidence
from visint.fields.snapshot import MapSnapshot, Writer
from visint.graph.graph import Graph
from visint.names import did_you_mean
from visint.results.derive import derived
from visint.results.premises import Premise, premises
from visint.results.provenance import Source, source_of
from visint.results.records import Measure, Record, Stop, Turn, Warned

__all__ = ["Result", "gather"]

_RELATIVE = "without a calibration depth is relative: known up to scale, and a stretch along the line of sight"


@dataclass(frozen=True, slots=True, eq=False)
class Result(Mapping[str, Any]):
    """The outputs of a run by name, ``result["depth"]``, and everything else it leaves.

    Attributes
    ----------
    graph, inputs, seed
        What was run, on what, from which seed.
    outputs
        Every output: arrays, and what else the graph gives. Derived ones included.
    kinds
        The field kind of each.
    confidence
        float32 (H, W) in [0, 1] by output, where it is known.
    evidence
        What each spoke said last, by spoke.
    attribution
        Field of the map → cue → float32 (H, W) in [0, 1]: how much of the field the cue decided. Over the cues
        they sum to at most 1; the rest is the start's. Empty unless the run was asked to follow it.
    writers
        Who wrote the field of the map that an output was read from last.
    record
        Turns, stops, warnings, measures and timings.
    seconds
        How long the run took.
    """

    graph: Graph
    inputs: Mapping[str, Any]
    outputs: Mapping[str, Any]
    kinds: Mapping[str, str]
    confidence: Mapping[str, Array] = field(default_factory=dict)
    evidence: Mapping[str, Evidence] = field(default_factory=dict)
    attribution: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    writers: Mapping[str, Writer] = field(default_factory=dict)
    record: Record = field(default_factory=Record)
    seed: int = 0
    seconds: float = 0.0

    def __getitem__(self, name: str) -> Any:
        if name not in self.outputs:
            near = did_you_mean(name, self.outputs)
            hint = f"; did you mean {near!r}?" if near else f"; there are {', '.join(self.outputs)}"
            raise KeyError(f"no output {name!r}{hint}")
        return self.outputs[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.outputs)

    def __len__(self) -> int:
        return len(self.outputs)

    def __repr__(self) -> str:
        outputs = ", ".join(f"{name}: {kind}" for name, kind in self.kinds.items())
        return f"<Result of {self.graph.name!r}: {outputs}; {self.seconds:.2f} s>"

    def _repr_html_(self) -> str:
        """The outputs as small pictures, for notebooks; :func:`visint.show` has the whole report."""
        from visint.results.report.notebook import html_of

        return html_of(self)

    @property
    def camera(self) -> Camera | None:
        """The camera among the inputs, if there was one."""
        return next((value for value in self.inputs.values() if isinstance(value, Camera)), None)

    @property
    def trace(self) -> list[Turn]:
        """How much each watched value changed, turn by turn."""
        return self.record.turns

    @property
    def stops(self) -> list[Stop]:
        """Why each loop ended, each time it ran."""
        return self.record.stops

    @property
    def warnings(self) -> list[Warned]:
        """What modules and the engine had to say."""
        return self.record.warnings

    @property
    def measures(self) -> list[Measure]:
        """The numbers that modules recorded."""
        return self.record.measures

    @property
    def assumptions(self) -> dict[str, dict[str, Premise]]:
        """By node and name: the assumptions of the modules, and in which regions they held or did not."""
        return premises(self.graph, self.record)

    def save(
        self,
        folder: str | PathLike[str],
        *,
        force: bool = False,
        sources: Mapping[str, Source | str | PathLike[str]] | None = None,
        against: str | PathLike[str] | None = None,
    ) -> tuple[str, ...]:
        """Writes every artifact, and gives their file names; all are there, or none.

        Parameters
        ----------
        folder
            Missing, empty or a former run.
        force
            Take a folder that holds other things too.
        sources
            The file that each input was read from; with them the run can be done again from ``run.json``.
        against
            The folder of another run: the report compares this one with it, map by map.

        Raises
        ------
        InputError
            If the other run cannot be read.
        OutputError
            If the folder is refused or the disk is.
        """
        from visint.results.artifacts import save

        read = {name: source_of(one) for name, one in (sources or {}).items()}
        return save(self, folder, force=force, sources=read, against=against)


def gather(  # noqa: PLR0913 - all that a run leaves, put together in this one place
    graph: Graph,
    inputs: Mapping[str, Any],
    outputs: Mapping[str, Any],
    *,
    maps: Mapping[str, MapSnapshot | None],
    evidence: Mapping[str, Evidence],
    record: Record,
    attribution: Mapping[str, Mapping[str, Array]] | None = None,
    seed: int = 0,
    seconds: float = 0.0,
) -> Result:
    """The result made of what the engine holds at the end of a run; derives what follows from a camera."""
    typed = {name: (graph.outputs[name].kind.name, value) for name, value in outputs.items()}
    camera = next((value for value in inputs.values() if isinstance(value, Camera)), None)
    confidence: dict[str, Array] = {}
    writers: dict[str, Writer] = {}
    for name, snapshot in maps.items():
        field_name = _field_of(graph, name)
        sure = snapshot.confidence.get(field_name) if snapshot else None
        if sure is not None and graph.outputs[name].kind.name != "Confidence":
            confidence[name] = sure
        if snapshot and field_name in snapshot.writers:
            writers[name] = snapshot.writers[field_name]
    origins = {}
    for name, (kind, value, origin) in derived(typed, camera).items():
        typed[name], origins[name] = (kind, value), origin
    for name, (_, value) in typed.items():
        if isinstance(value, Evidence):
            confidence[name] = value.reliability
    confidence |= {name: confidence[origin] for name, origin in origins.items() if origin in confidence}
    values = {name: _plain(value) for name, (_, value) in typed.items()}
    kinds = {name: kind for name, (kind, _) in typed.items()}
    if "Depth" in kinds.values() and (maps if camera is None else not camera.calibrated):
        guessed = f"; a focal length of {camera.focal_length:g} pixels is a guess" if camera else ""
        record.warnings.append(Warned("camera", 0, 0, "relative_depth", _RELATIVE + guessed))
    record.warnings += _absent(graph, outputs, record)
    weights = attribution or {}
    return Result(
        graph, dict(inputs), values, kinds, confidence, evidence, weights, writers, record, seed, seconds
    )


def _absent(graph: Graph, outputs: Mapping[str, Any], record: Record) -> list[Warned]:
    """Outputs that the graph declares and nothing filled, though it ran to its end."""
    if record.stop_after is not None:
        return []
    said = "nothing wrote it: no file is made of it"
    return [Warned(f"outputs.{name}", 0, 0, "absent", said) for name in graph.outputs if name not in outputs]


def _field_of(graph: Graph, output: str) -> str:
    """The stored field behind an output read from the map: derived ones follow from depth or boundaries."""
    port = graph.outputs[output].source.port
    port = port.removesuffix("_confidence")
    return {"disparity": "depth", "normals": "depth", "slopes": "depth", "regions": "boundaries"}.get(
        port, port
    )


def _plain(value: Any) -> Any:
    import numpy as np

    value = value.value if isinstance(value, Evidence) else value
    return read_only(value) if isinstance(value, np.ndarray) else value
