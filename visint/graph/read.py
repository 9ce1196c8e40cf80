"""Reading a graph file: YAML 1.2 (or JSON) to plain data with the place of every value, then to a spec.

Graph files are untrusted: size, depth and number of values are bounded before anything is built, and there
are no tags, anchors, aliases, merge keys or templates. ruamel only splits the text into events.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from visint import io
from visint.errors import GraphError, InputError, Problem, Where
from visint.graph.complaints import complaints
from visint.graph.spec import VERSION, GraphSpec

__all__ = ["Places", "Source", "parse", "parse_data", "parse_value", "read_graph"]

LARGEST = 1 << 20
DEEPEST = 24
LONGEST = 50_000
Path_ = tuple[str | int, ...]


class Mark(NamedTuple):
    """Line and column, from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Places:
    """Where in a file the value, and the key, of each path of keys stands."""

    file: str
    values: Mapping[Path_, Mark] = field(default_factory=dict)
    keys: Mapping[Path_, Mark] = field(default_factory=dict)

    def where(self, *path: str | int, key: bool = False) -> Where:
        """The place of ``path``, or of the nearest thing above it that stands in the file."""
        for length in range(len(path), -1, -1):
            book = self.keys if key and length == len(path) else self.values
            mark = book.get(path[:length])
            if mark is not None:
                return Where(self.file, mark.line, mark.column, ".".join(map(str, path)))
        return Where(self.file, path=".".join(map(str, path)))


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
        raise GraphError(
            Problem("VI101", problem.found, Where(str(path))) for problem in error.problems
        ) from error
    return parse(text, str(path))


def parse(text: str, file: str = "graph") -> Source:
    """The graph in ``text``, a whole graph file; ``file`` is what messages call it. Raises as `read_graph`."""
    data, places = _Composer(text, file).compose()
    return _source(data, places)


def parse_data(data: Any, file: str = "graph") -> Source:
    """The graph in plain ``data``, such as a run record holds; raises as :func:`read_graph`, without lines."""
    return _source(data, Places(file))


def parse_value(text: str) -> Any:
    """A single value as graph files spell it: ``5``, ``1e-4``, ``true``, ``[1, 2]``, ``word``."""
    return _Composer(text, text[:60]).compose()[0]


def _source(data: Any, places: Places) -> Source:
    if not isinstance(data, dict):
        wanted = "a graph file is a mapping with the keys visint, name, nodes, outputs"
        raise GraphError(Problem("VI105", f"{wanted}; this is {_kind(data)}", places.where()))
    _version(data, places)
    try:
        return Source(GraphSpec.model_validate(data), places)
    except ValidationError as error:
        raise GraphError(complaints(error, data, places.where)) from None


def _version(data: Mapping[str, Any], places: Places) -> None:
    found = data.get("visint")
    if found is None or isinstance(found, bool) or found != VERSION:
        said = "is missing" if found is None else f"is {found!r}"
        wanted = f"the format version {said}; this visint reads version {VERSION}"
        raise GraphError(Problem("VI106", wanted, places.where("visint"), write=f"visint: {VERSION}"))


def _kind(data: Any) -> str:
    return {list: "a list", str: "text", type(None): "empty"}.get(type(data), f"a {type(data).__name__}")


_INT = re.compile(r"[-+]?[0-9]{1,18}\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_WORDS = (
    dict.fromkeys(("", "~", "null", "Null", "NULL"))
    | dict.fromkeys(("true", "True", "TRUE"), True)
    | dict.fromkeys(("false", "False", "FALSE"), False)
)


def _scalar(text: str) -> Any:
    """A plain scalar by the core schema of YAML 1.2 (so ``1e-4`` is a number and ``no`` is text)."""
    if text in _WORDS:
        return _WORDS[text]
    if _INT.match(text):
        return int(text)
    if _FLOAT.match(text) and math.isfinite(float(text)):
        return float(text)
    return text


class _Composer:
    """Builds plain data from parse events, minding the limits and keeping the places."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        self.values: dict[Path_, Mark] = {}
        self.keys: dict[Path_, Mark] = {}
        self.count = 0

    def compose(self) -> tuple[Any, Places]:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import YAMLError

        try:
            self.events: Iterator[Any] = iter(YAML(typ="safe", pure=True).parse(self.text))
            data = self._document()
        except YAMLError as error:
            raise self._syntax(error) from None
        except (ValueError, AssertionError, IndexError, AttributeError, RecursionError) as error:
            raise GraphError(Problem("VI102", f"not well-formed: {error}", Where(self.file))) from None
        return data, Places(self.file, self.values, self.keys)

    def _document(self) -> Any:
        self._next()  # the stream begins
        event = self._next()
        if type(event).__name__ == "StreamEndEvent":
            return None
        data = self._value(self._next(), ())
        self._next()  # the document ends
        if type(extra := self._next()).__name__ == "DocumentStartEvent":
            raise self._error("VI105", "a graph file holds one document; a second begins here", extra, ())
        return data

    def _next(self) -> Any:
        event = next(self.events)
        self.count += 1
        if self.count > LONGEST:
            raise self._error("VI107", f"more than {LONGEST} values", event, ())
        return event

    def _value(self, event: Any, path: Path_) -> Any:
        self.values[path] = self._mark(event)
        self._plain_yaml(event, path)
        if len(path) > DEEPEST:
            raise self._error("VI107", f"nested deeper than {DEEPEST}", event, ())
        kind = type(event).__name__
        if kind == "MappingStartEvent":
            return self._mapping(path)
        if kind == "SequenceStartEvent":
            return self._sequence(path)
        return _scalar(event.value) if event.implicit[0] else event.value

    def _mapping(self, path: Path_) -> dict[Any, Any]:
        data: dict[Any, Any] = {}
        while type(event := self._next()).__name__ != "MappingEndEvent":
            if type(event).__name__ != "ScalarEvent":
                raise self._error("VI103", "a key is a word or a number", event, path)
            self._plain_yaml(event, path)
            key = _scalar(event.value) if event.implicit[0] else event.value
            if key == "<<":
                raise self._error("VI103", "graph files have no merge keys ('<<')", event, path)
            if key in data:
                raise self._error("VI104", f"the key {key!r} stands twice", event, (*path, key))
            self.keys[*path, key] = self._mark(event)
            data[key] = self._value(self._next(), (*path, key))
        return data

    def _sequence(self, path: Path_) -> list[Any]:
        data: list[Any] = []
        while type(event := self._next()).__name__ != "SequenceEndEvent":
            data.append(self._value(event, (*path, len(data))))
        return data

    def _plain_yaml(self, event: Any, path: Path_) -> None:
        if type(event).__name__ == "AliasEvent":
            raise self._error("VI103", f"graph files have no aliases (*{event.anchor})", event, path)
        if getattr(event, "anchor", None):
            raise self._error("VI103", f"graph files have no anchors (&{event.anchor})", event, path)
        if getattr(event, "tag", None):
            raise self._error("VI103", f"graph files have no tags ({event.tag})", event, path)

    def _mark(self, event: Any) -> Mark:
        return Mark(event.start_mark.line + 1, event.start_mark.column + 1)

    def _error(self, code: str, found: str, event: Any, path: Path_) -> GraphError:
        mark = self._mark(event)
        return GraphError(
            Problem(code, found, Where(self.file, mark.line, mark.column, ".".join(map(str, path))))
        )

    def _syntax(self, error: Any) -> GraphError:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        spot = Where(self.file, mark.line + 1, mark.column + 1) if mark else Where(self.file)
        said = " ".join(str(getattr(error, "problem", None) or error).split())[:200]
        return GraphError(Problem("VI102", f"not well-formed YAML: {said}", spot))
