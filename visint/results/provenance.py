"""Where a result comes from: everything that is needed to get the same bytes again, and nothing that changes."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydantic import BaseModel

import visint
from visint.arrays import Array
from visint.graph.graph import Graph

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["LIBRARIES", "Source", "provenance"]

LIBRARIES = ("numpy", "opencv-python-headless", "scipy", "numba", "networkx", "pydantic", "pluggy")
"""The libraries whose version may change a result."""


class Source(NamedTuple):
    """Where an input was read from: file paths (one, or several for a list), or a value as text."""

    paths: tuple[str, ...] = ()
    text: str = ""
    gamma: float | None = None


def provenance(result: Result, sources: Mapping[str, Source]) -> dict[str, Any]:
    """The content of ``run.json`` but for the list of files: the same run gives the same text."""
    graph = result.graph
    return {
        "visint": visint.__version__,
        "graph": graph.spec.plain(),
        "graph_hash": _sha(graph.to_yaml().encode()),
        "seed": result.seed,
        "inputs": {name: _input(value, sources.get(name)) for name, value in result.inputs.items()},
        "outputs": {name: _output(result, name) for name in result.outputs},
        "modules": _modules(graph),
        "parameters": {name: _params(node.params) for name, node in graph.nodes.items()},
        "libraries": {"python": platform.python_version(), **{name: _version(name) for name in LIBRARIES}},
        "stops": [stop._asdict() for stop in result.stops],
        "trace": [_finite(turn._asdict()) for turn in result.trace],
        "warnings": [warned._asdict() for warned in result.warnings],
        "measures": [_finite(measure._asdict()) for measure in result.record.measures],
    }


def _input(value: Any, source: Source | None) -> dict[str, Any]:
    told: dict[str, Any] = {"sha256": _digest(value)}
    if isinstance(value, BaseModel):
        told["value"] = value.model_dump(mode="json")
    elif isinstance(value, float | int | str | bool):
        told["value"] = value
    if source is not None:
        told |= {key: one for key, one in source._asdict().items() if one not in ((), "", None)}
    return told


def _output(result: Result, name: str) -> dict[str, Any]:
    value = result.outputs[name]
    told: dict[str, Any] = {"kind": result.kinds[name], "sha256": _digest(value)}
    if isinstance(value, np.ndarray):
        told["shape"] = list(value.shape)
    elif isinstance(value, float | int | str | bool):
        told["value"] = value
    if name in result.writers:
        told["last_written_by"] = result.writers[name]._asdict()
    return told


def _digest(value: Any) -> str:
    if isinstance(value, tuple):
        return _sha("".join(_digest(one) for one in value).encode())
    if isinstance(value, np.ndarray):
        return array_digest(value)
    if isinstance(value, BaseModel):
        return _sha(value.model_dump_json().encode())
    return _sha(repr(value).encode())


def array_digest(array: Array) -> str:
    """SHA-256 of an array's type, shape and bytes, in hexadecimal."""
    head = f"{array.dtype.str}{array.shape}".encode()
    return _sha(head + np.ascontiguousarray(array).tobytes())


def _sha(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _modules(graph: Graph) -> dict[str, dict[str, str]]:
    callees = {node.callee.id: node.callee for node in graph.nodes.values() if node.callee.module}
    return {name: {"version": callees[name].version, "from": callees[name].origin} for name in sorted(callees)}


def _params(params: Any) -> Any:
    return params.model_dump(mode="json") if isinstance(params, BaseModel) else dict(params)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _finite(row: dict[str, Any]) -> dict[str, Any]:
    """JSON has no NaN and no infinity: they are spelled out."""
    return {
        key: repr(value) if isinstance(value, float) and not np.isfinite(value) else value
        for key, value in row.items()
    }
