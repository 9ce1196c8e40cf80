"""Running again from the ``run.json`` of a former run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from visint.errors import InputError, Problem

if TYPE_CHECKING:
    from visint.graph import Graph
    from visint.results import Result, Source

__all__ = ["Former", "former"]


class Former(NamedTuple):
    """A former run: its graph, seed, last node, the fields it started from, and what its inputs were.

    ``attribution`` says whether it followed which cue decided what.
    """

    path: Path
    graph: Graph
    seed: int
    stop_after: str
    start: Mapping[str, str]
    inputs: Mapping[str, Mapping[str, Any]]
    attribution: bool = True

    def sources(self, given: Mapping[str, Source]) -> dict[str, Source]:
        """Where its inputs were read from; what is ``given`` now goes first.

        Raises
        ------
        InputError
            VI304 if an input came from no file and is not given, all of them together.
        """
        found: dict[str, Source] = {}
        problems: list[Problem] = []
        for name, told in self.inputs.items():
            try:
                found[name] = given[name] if name in given else self._former_source(name, told)
            except InputError as error:
                problems += error.problems
        if problems:
            raise InputError(problems)
        return found | dict(given)

    def _former_source(self, name: str, told: Mapping[str, Any]) -> Source:
        from visint.results import Source

        paths, text, gamma = told.get("paths", []), told.get("text", ""), told.get("gamma")
        if not (_all_texts(paths) and isinstance(text, str) and isinstance(gamma, float | int | None)):
            raise _no_record(self.path)
        text = text or ("" if paths else _spelled(told.get("value")))
        if not paths and not text:
            found = f"the input {name!r} of that run did not come from a file"
            raise InputError.of("VI304", found, where=str(self.path), write=f"--in {name}=PATH")
        return Source(tuple(paths), text, gamma)

    def changed(self, result: Result, given: Mapping[str, Source]) -> Iterator[str]:
        """The inputs of ``result`` that are not what they were, though nobody gave other files."""
        from visint.results.provenance import provenance

        now = provenance(result, {})["inputs"]
        for name, told in self.inputs.items():
            if name not in given and name in now and told.get("sha256") != now[name]["sha256"]:
                yield name


def former(path: Path) -> Former:
    """The run recorded in ``path``.

    Raises
    ------
    InputError
        VI302 if the file is no run record.
    GraphError
        If the graph in it is no longer sound here.
    """
    from visint import io
    from visint.graph.bind import bind
    from visint.graph.read import parse_data
    from visint.registry import installed
    from visint.results.provenance import ABSENT

    record = io.read_json(path)
    if not _is_record(record):
        raise _no_record(path)
    source = parse_data(record["graph"], str(path))
    graph = bind(source.spec, installed().with_recorded(record.get("graphs", {})), source.places)
    inputs = {name: told for name, told in record["inputs"].items() if told.get("sha256") != ABSENT}
    stop_after, start = record.get("stop_after") or "", record.get("start") or {}
    followed = bool(record.get("attribution"))
    return Former(path, graph, record["seed"], stop_after, start, inputs, followed)


def _spelled(value: Any) -> str:
    """A number, a flag, a text or a light that was given in Python, as the command line has it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float | str):
        return str(value)
    vector = value.get("vector") if isinstance(value, dict) else None
    if not (isinstance(vector, list) and all(isinstance(one, float | int) for one in vector)):
        return ""
    text = ",".join(map(repr, vector))
    return f"at {text}" if value.get("place") == "point" else text


def _is_record(record: Any) -> bool:
    return (
        isinstance(record, dict)
        and isinstance(record.get("graph"), dict)
        and isinstance(record.get("graphs", {}), dict)
        and isinstance(record.get("seed"), int)
        and isinstance(record.get("inputs"), dict)
        and all(isinstance(told, dict) for told in record["inputs"].values())
        and isinstance(record.get("stop_after"), str | None)
        and isinstance(record.get("start", {}), dict)
    )


def _all_texts(paths: Any) -> bool:
    return isinstance(paths, list) and all(isinstance(path, str) for path in paths)


def _no_record(path: Path) -> InputError:
    error = InputError.of("VI302", "is no run record of visint", where=str(path))
    assert isinstance(error, InputError)
    return error
