"""Where a result comes from: all that is needed to get the same bytes again, and nothing that changes."""

from __future__ import annotations

import hashlib
import math
import platform
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydantic import BaseModel
from pydantic_core import PydanticSerializationError

from visint.arrays import Array
from visint.graph.graph import Callee, Graph

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = [
    "ABSENT",
    "LIBRARIES",
    "Source",
    "installed_version",
    "libraries",
    "modules",
    "parameters",
    "provenance",
    "source_of",
    "unit_of",
]

ABSENT = "absent"
"""Stands for the digest of an optional input that was not given."""

LIBRARIES = ("numpy", "opencv-python-headless", "scipy", "numba", "networkx", "pydantic", "pluggy")
"""The libraries whose version may change a result."""


class Source(NamedTuple):
    """Where an input was read from: file paths (one, or several for a list), or a value as text."""

    paths: tuple[str, ...] = ()
    text: str = ""
    gamma: float | None = None


def source_of(given: Source | str | PathLike[str]) -> Source:
    """A source, or the path of one file as one."""
    return given if isinstance(given, Source) else Source((str(Path(given).absolute()),))


def provenance(result: Result, sources: Mapping[str, Source]) -> dict[str, Any]:
    """The content of ``run.json`` but for the list of files: the same run gives the same text."""
    graph = result.graph
    told: dict[str, Any] = {
        "visint": installed_version("visint"),
        "graph": graph.spec.plain(),
        "graph_hash": _sha(graph.to_yaml().encode()),
        "graphs": {name: called.spec.plain() for name, called in sorted(dict(_called(graph)).items())},
        "seed": result.seed,
        "stop_after": result.record.stop_after,
        "start": {name: _digest(value) for name, value in result.record.start.items()},
        "inputs": {name: _input(value, sources.get(name)) for name, value in result.inputs.items()},
        "outputs": {name: _output(result, name) for name in result.outputs},
        "modules": modules(graph),
        "parameters": parameters(graph),
        "libraries": libraries(),
        "stops": [stop._asdict() for stop in result.stops],
        "trace": [turn._asdict() for turn in result.trace],
        "warnings": [warned._asdict() for warned in result.warnings],
        "attribution": {
            name: {cue: _mean(weight) for cue, weight in weights.items()}
            for name, weights in result.attribution.items()
        },
        "evidence_units": dict(_units(result)),
        "assumptions": {
            node: {name: premise.plain() for name, premise in some.items()}
            for node, some in result.assumptions.items()
        },
        "measures": [measure._asdict() for measure in result.record.measures],
    }
    return {key: _spelled(one) for key, one in told.items()}


def _mean(weight: Array) -> float:
    """The mean of a map of weights, rounded to what is worth telling."""
    return round(float(weight.mean(dtype=np.float64)), 6)


def _units(result: Result) -> Iterator[tuple[str, str]]:
    """The unit of each array of ``evidence.npz``; that of the baseline by its name."""
    camera = result.camera
    for name, one in result.evidence.items():
        kind = result.graph.catalog.kind(one.measures)
        unit = kind.array.unit if kind and kind.array else "1"
        unit = unit.replace("baseline", camera.unit if camera else "relative")
        yield f"{name}.{one.measures.lower()}", unit
        yield f"{name}.sigma", "rad" if one.measures == "Normals" else unit
        yield f"{name}.reliability", "1"
    for name, weights in result.attribution.items():
        yield from ((f"{cue}.share_of_{name}", "1") for cue in weights)


def _input(value: Any, source: Source | None) -> dict[str, Any]:
    told: dict[str, Any] = {"sha256": _digest(value)}
    if isinstance(value, float | int | str | bool | BaseModel):
        told |= _value(value)
    if source is not None:
        told |= {key: one for key, one in source._asdict().items() if one not in ((), "", None)}
    return told


def _value(value: Any) -> dict[str, Any]:
    """The value itself, if JSON can say it; a stranger's model may hold arrays."""
    if not isinstance(value, BaseModel):
        return {"value": value}
    try:
        return {"value": value.model_dump(mode="json")}
    except PydanticSerializationError:
        return {}


def _output(result: Result, name: str) -> dict[str, Any]:
    value = result.outputs[name]
    told: dict[str, Any] = {"kind": result.kinds[name], "sha256": _digest(value)}
    if isinstance(value, np.ndarray):
        told |= {"shape": list(value.shape), "unit": unit_of(result, result.kinds[name])}
    elif isinstance(value, float | int | str | bool):
        told["value"] = value
    if name in result.writers:
        told["last_written_by"] = result.writers[name]._asdict()
    return told


def unit_of(result: Result, kind: str) -> str:
    """What an array of ``kind`` is measured in; lengths in the camera's unit, ``relative`` without one."""
    found = result.graph.catalog.kind(kind)
    unit = found.array.unit if found and found.array else ""
    return unit.replace("baseline", result.camera.unit if result.camera else "relative")


def _digest(value: Any) -> str:
    if value is None:
        return ABSENT
    if isinstance(value, tuple):
        return _sha("".join(_digest(one) for one in value).encode())
    if isinstance(value, np.ndarray):
        return array_digest(value)
    if isinstance(value, BaseModel):
        return _sha("".join(f"{name}={_digest(one)};" for name, one in value).encode())
    text = repr(value)
    return _sha((type(value).__qualname__ if " at 0x" in text else text).encode())


def array_digest(array: Array) -> str:
    """SHA-256 of an array's type, shape and bytes, in hexadecimal."""
    head = f"{array.dtype.str}{array.shape}".encode()
    return _sha(head + np.ascontiguousarray(array).tobytes())


def _sha(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def modules(graph: Graph) -> dict[str, dict[str, str]]:
    """Version and origin of every module that the graph calls, sub-graphs included, by its id."""
    callees = {callee.id: callee for callee in _callees(graph) if callee.module}
    return {name: {"version": callees[name].version, "from": callees[name].origin} for name in sorted(callees)}


def _called(graph: Graph) -> Iterator[tuple[str, Graph]]:
    """The graphs that it calls, and those that they call, by name."""
    for node in graph.nodes.values():
        if node.callee.graph is not None:
            yield node.callee.id.partition(":")[2], node.callee.graph
            yield from _called(node.callee.graph)


def _callees(graph: Graph) -> Iterator[Callee]:
    for node in graph.nodes.values():
        yield node.callee
        if node.callee.graph is not None:
            yield from _callees(node.callee.graph)


def parameters(graph: Graph) -> dict[str, dict[str, Any]]:
    """The parameters of every node, defaults included, by node."""
    return {name: _params(node.params) for name, node in graph.nodes.items()}


def _params(params: Any) -> dict[str, Any]:
    return params.model_dump(mode="json") if isinstance(params, BaseModel) else dict(params)


def libraries() -> dict[str, str]:
    """Versions of Python and of :data:`LIBRARIES`."""
    return {
        "python": platform.python_version(),
        **{name: installed_version(name) for name in LIBRARIES},
    }


def installed_version(name: str) -> str:
    """The version of an installed distribution, visint itself included; "not installed" if it is not."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _spelled(told: Any) -> Any:
    """JSON has no NaN and no infinity: they are spelled out, wherever they stand."""
    if isinstance(told, Mapping):
        return {key: _spelled(one) for key, one in told.items()}
    if isinstance(told, list | tuple):
        return [_spelled(one) for one in told]
    return repr(float(told)) if isinstance(told, float) and not math.isfinite(told) else told
