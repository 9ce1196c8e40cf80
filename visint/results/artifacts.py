"""The files of a result: one an output by its name and kind, and the records."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import numpy as np

from visint import io
from visint.arrays import Array
from visint.fields.evidence import Evidence
from visint.results import pictures
from visint.results.against import read_against
from visint.results.provenance import Source, provenance, unit_of
from visint.results.report import report
from visint.results.solid import solid

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["files_of", "save"]

Files = Iterator[tuple[str, bytes]]


def save(
    result: Result,
    folder: str | PathLike[str],
    *,
    force: bool,
    sources: Mapping[str, Source],
    against: str | PathLike[str] | None = None,
) -> tuple[str, ...]:
    """Writes every file of ``result`` into ``folder``, all or none; gives their names."""
    other = None if against is None else read_against(against)
    with io.OutputFolder(fspath(folder), force=force) as place:
        for name, data in files_of(result):
            place.write(name, data)
        place.write("profile.json", _json(_profile(result)))
        place.write("report.html", report(result, other).encode())
        files = [*place.files, "run.json"]
        place.write("run.json", _json({**provenance(result, sources), "files": files}))
        return place.files


def files_of(result: Result) -> Files:
    """(file name, bytes) of every output, its confidence, the evidence, points and surface; made one by one."""
    writers = result.graph.catalog.writers()
    for name, kind, value in _one_by_one(result):
        if kind in writers:
            yield from writers[kind](name, value).items()
        elif kind in _BY_KIND:
            yield from _BY_KIND[kind](name, value)
        elif isinstance(value, np.ndarray):
            yield f"{name}.npz", io.encode_npz({name: value}, {name: unit_of(result, kind)})
    for name, value in result.confidence.items():
        if f"{name}_confidence" not in result.outputs:  # the graph may give it as an output of its own
            yield f"{name}_confidence.pfm", io.encode_pfm(value)
    if result.evidence or result.attribution:
        arrays = {**dict(_evidence(result.evidence)), **dict(_shares(result))}
        yield "evidence.npz", io.encode_npz(arrays, dict(_units(result)))
    yield from solid(result)


def _one_by_one(result: Result) -> Iterator[tuple[str, str, Any]]:
    """(name, kind, value) of each output; of a list ``NAME_0``, ``NAME_1``, …"""
    for name, value in result.outputs.items():
        if isinstance(value, tuple):
            yield from ((f"{name}_{i}", result.kinds[name], one) for i, one in enumerate(value))
        else:
            yield name, result.kinds[name], value


def _pfm(name: str, value: Array) -> Files:
    yield f"{name}.pfm", io.encode_pfm(value)


def _disparity(name: str, value: Array) -> Files:
    yield from _pfm(name, value)
    if io.fits_kitti(value):
        yield f"{name}.png", io.encode_kitti(value)


def _normals(name: str, value: Array) -> Files:
    yield f"{name}.npz", io.encode_npz({name: value}, {name: "1"})
    yield f"{name}.png", io.encode_png(pictures.of_normals(value))


def _mask(name: str, value: Array) -> Files:
    yield f"{name}.png", io.encode_png(value)


def _boundary_kinds(name: str, value: Array) -> Files:
    yield f"{name}.npz", io.encode_npz({name: value}, {name: "1"})
    yield f"{name}.png", io.encode_png(pictures.of_boundary_kinds(value))


def _regions(name: str, value: Array) -> Files:
    yield f"{name}.npz", io.encode_npz({name: value}, {name: "1"})
    yield f"{name}.png", io.encode_png(pictures.of_regions(value))


_BY_KIND: Mapping[str, Callable[[str, Any], Files]] = {
    **dict.fromkeys(("Depth", "Relief", "Image", "Color", "Confidence", "Sigma", "Incidence"), _pfm),
    "Disparity": _disparity,
    "Normals": _normals,
    "Boundaries": _mask,
    "BoundaryKinds": _boundary_kinds,
    "Mask": _mask,
    "Regions": _regions,
}


def _evidence(evidence: Mapping[str, Evidence]) -> Iterator[tuple[str, Array]]:
    for name, one in evidence.items():
        yield f"{name}.{one.measures.lower()}", one.value
        yield f"{name}.sigma", one.sigma
        yield f"{name}.reliability", one.reliability


def _units(result: Result) -> Iterator[tuple[str, str]]:
    """What value and sigma of each evidence are measured in."""
    for name, one in result.evidence.items():
        unit = unit_of(result, one.measures)
        yield from ((f"{name}.{part}", unit) for part in (one.measures.lower(), "sigma"))


def _shares(result: Result) -> Iterator[tuple[str, Array]]:
    """How much of each field each cue decided."""
    for name, weights in result.attribution.items():
        yield from ((f"{cue}.share_of_{name}", weight) for cue, weight in weights.items())


def _profile(result: Result) -> dict[str, Any]:
    return {
        "graph": result.graph.name,
        "seconds": result.seconds,
        "nodes": [timing._asdict() for timing in result.record.timings()],
    }


def _json(data: Any) -> bytes:
    return (json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()
