"""Reading a graph file: YAML 1.2 (or JSON) to plain data with the place of every value, then to a spec.

Graph files are untrusted: size, depth and number of values are bounded before anything is built, and there
are no tags, anchors, aliases, merge keys or templates. ruamel only splits the text into events.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from visint import io
from visint.errors import GraphError, InputError, Problem, Where
from visint.graph.complaints import complaints, keys_of, shown
from visint.graph.compose import Places, compose
from visint.graph.limits import LARGEST
from visint.graph.spec import VERSION, GraphSpec
from visint.names import listed

__all__ = ["Places", "Source", "parse", "parse_data", "parse_value", "read_graph"]


class Source(NamedTuple):
    """A graph as read: its spec, and where each part of it stands."""

    spec: GraphSpec
    places: Places


def read_graph(path: Path) -> Source:
    """The graph in the file ``path``.

    Raises
    ------
    GraphError
        VI101 to VI107, with file, line and column; all problems of the phase together.
    """
    try:
        text = io.read_text(path, most=LARGEST)
    except InputError as error:
        raise GraphError(_unreadable(problem) for problem in error.problems) from error
    return parse(text, str(path))


def _unreadable(problem: Problem) -> Problem:
    if problem.code == "VI301":  # no file: there is no line to point at
        found = "there is no such graph file" if problem.found == "no such file" else problem.found
        write = problem.write or "visint check NAME   (a shipped graph, or the path of a file)"
        return Problem("VI101", found, Where(problem.where.file), problem.choices, write)
    code = "VI107" if problem.code == "VI303" else "VI101"
    place = Where(problem.where.file, problem.where.line or 1, problem.where.column or 1)
    empty = problem.found == "is empty"
    write = f"visint: {VERSION}" if empty else "(the file, saved as UTF-8)" if problem.code == "VI302" else ""
    return Problem(code, f"the file {problem.found}", place, problem.choices, problem.write or write)


def parse(text: str, file: str = "graph") -> Source:
    """The graph in ``text``, a whole graph file; ``file`` is what messages call it. Raises as `read_graph`."""
    return _source(*compose(text, file))


def parse_data(data: Any, file: str = "graph") -> Source:
    """The graph in plain ``data``, such as a run record holds; raises as :func:`read_graph`, without lines."""
    return _source(data, Places(file))


def parse_value(text: str) -> Any:
    """A single value as graph files spell it: ``5``, ``1e-4``, ``true``, ``[1, 2]``, ``word``."""
    return compose(text, text[:60])[0]


def _source(data: Any, places: Places) -> Source:
    if not isinstance(data, dict):
        found = f"a graph file is a mapping, {{key: value}}; found {shown(data)}"
        keys = "keys here: " + listed(keys_of(GraphSpec))
        raise GraphError(Problem("VI105", found, places.where(), keys, f"visint: {VERSION}"))
    _version(data, places)
    try:
        return Source(GraphSpec.model_validate(data), places)
    except ValidationError as error:
        raise GraphError(complaints(error, data, places.where)) from None


def _version(data: Mapping[str, Any], places: Places) -> None:
    found = data.get("visint")
    if type(found) is not int or found != VERSION:
        said = "is missing" if found is None else f"is {str(found)[:20]!r}"
        wanted = f"the format version {said}; this visint reads version {VERSION}"
        raise GraphError(Problem("VI106", wanted, places.where("visint"), write=f"visint: {VERSION}"))
