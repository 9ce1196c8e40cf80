"""Running again from the ``run.json`` of a former run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from visint.errors import InputError

if TYPE_CHECKING:
    from visint.graph import Graph
    from visint.results import Source

__all__ = ["former"]


def former(path: Path) -> tuple[Graph, dict[str, Source], int]:
    """The graph, the sources of the inputs and the seed of the run recorded in ``path``.

    Raises
    ------
    InputError
        VI302 if the file is no run record; VI304 if the run's inputs did not come from files.
    GraphError
        If the graph in it is no longer sound here.
    """
    from visint import io
    from visint.graph.bind import bind
    from visint.graph.read import parse_data
    from visint.registry import installed

    record = io.read_json(path)
    if not isinstance(record, dict) or not {"graph", "inputs", "seed"} <= set(record):
        raise InputError.of("VI302", "is no run record of visint", where=str(path))
    source = parse_data(record["graph"], str(path))
    graph = bind(source.spec, installed(), source.places)
    sources = {name: _source(name, told, path) for name, told in record["inputs"].items() if _given(told)}
    return graph, sources, int(record["seed"])


def _given(told: dict[str, Any]) -> bool:
    from visint.results.provenance import ABSENT

    return bool(told.get("sha256") != ABSENT)


def _source(name: str, told: dict[str, Any], path: Path) -> Source:
    from visint.results import Source

    if "paths" not in told and "text" not in told:
        found = f"the input {name!r} of that run did not come from a file"
        raise InputError.of("VI304", found, where=str(path), write=f"--in {name}=PATH")
    return Source(tuple(told.get("paths", ())), told.get("text", ""), told.get("gamma"))
