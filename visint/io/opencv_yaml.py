"""OpenCV's YAML, read safely: its own reader ends the process at one odd byte in a key.

ruamel splits the text into events, as for graph files; the tags ``!!opencv-matrix`` and, for vectors of newer
versions, ``!!opencv-nd-matrix`` are the only ones taken, and mean a shape and numbers. The first line,
``%YAML:1.0``, is no YAML and is passed over.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from visint.errors import InputError, Problem, Where

__all__ = ["Entry", "opencv_entries"]

_MATRICES = ("tag:yaml.org,2002:opencv-matrix", "tag:yaml.org,2002:opencv-nd-matrix")
_DEEPEST, _LONGEST = 6, 4_000
_MONSTER = re.compile(r"(?<![^\s,:])[^\s,:]{1001}|(?<!\s)\s{2001}|(?<![^\n])[^\n]{20001}")
_BRACKET = re.compile(r"[\[\]{}]")
_HEAD = re.compile(r"^%YAML.*$", re.MULTILINE)
_NUMBER = re.compile(r"[-+]?(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:[eE][-+]?\d{1,3})?\Z", re.ASCII)


class Entry(NamedTuple):
    """A value of a file, and its line: a number, a text, a list, a mapping, or float64 (rows, columns)."""

    value: Any
    line: int


def opencv_entries(text: str, name: str) -> Mapping[str, Entry]:
    """The entries at the top of an OpenCV YAML file, several documents of it together.

    Raises
    ------
    InputError
        VI306 with line and column: not well-formed, too deep or too long, other tags, anchors, aliases, a key
        twice, a matrix that is none.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    text = _HEAD.sub("", text)
    _refuse_monsters(text, name)
    try:
        return _Reader(iter(YAML(typ="safe", pure=True).parse(text)), name).entries()
    except (YAMLError, ArithmeticError, AttributeError, AssertionError, LookupError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        said = " ".join(str(getattr(error, "problem", None) or error).split())[:120]
        place = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        raise _wrong(name, f"is not well-formed YAML: {said}", *place) from None


def _refuse_monsters(text: str, name: str) -> None:
    """Parsing takes time by form, not size."""
    depth = 0
    for bracket in _BRACKET.finditer(text):
        depth += 1 if bracket[0] in "[{" else -1
        if depth > _DEEPEST:
            raise _wrong(name, f"has values nested deeper than {_DEEPEST}", *_spot(text, bracket.start()))
    long = _MONSTER.search(text)
    if long is not None:
        raise _wrong(name, "has a word, a line or a gap that no calibration has", *_spot(text, long.start()))
    if text.count("\n") > _LONGEST or sum(map(text.count, ("? ", "- ", "{", "["))) > _LONGEST:
        raise _wrong(name, f"has more than {_LONGEST} lines or values", 1, 1)


def _spot(text: str, at: int) -> tuple[int, int]:
    return text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at)


def _wrong(name: str, found: str, line: int, column: int, path: str = "") -> InputError:
    return InputError(Problem("VI306", found, Where(name, line, column, path), fault="input"))


class _Reader:
    """Builds entries from parse events, minding the limits."""

    def __init__(self, events: Iterator[Any], name: str) -> None:
        self.events, self.name, self.count = events, name, 0

    def entries(self) -> dict[str, Entry]:
        found: dict[str, Entry] = {}
        while (kind := type(event := self.next()).__name__) != "StreamEndEvent":
            if kind == "MappingStartEvent":
                self.plain(event)
                self.mapping(found)
            elif kind in ("SequenceStartEvent", "AliasEvent") or (kind == "ScalarEvent" and event.value):
                raise self.wrong(event, "is no OpenCV file; wants name: value")
        return found

    def next(self) -> Any:
        event = next(self.events)
        self.count += 1
        if self.count > _LONGEST:
            raise self.wrong(event, f"has more than {_LONGEST} values")
        return event

    def wrong(self, event: Any, found: str) -> InputError:
        return _wrong(self.name, found, event.start_mark.line + 1, event.start_mark.column + 1)

    def plain(self, event: Any) -> bool:
        """Refuse what no calibration has; whether the event begins a matrix."""
        if type(event).__name__ == "AliasEvent" or getattr(event, "anchor", None):
            raise self.wrong(event, "has anchors or aliases, which calibrations have not")
        tag = str(getattr(event, "tag", None) or "")
        if tag not in ("", *_MATRICES):
            raise self.wrong(event, f"has the tag {tag[:60]!r}; !!opencv-matrix is the only one read")
        return bool(tag)

    def mapping(self, found: dict[str, Entry], depth: int = 0) -> dict[str, Entry]:
        while type(event := self.next()).__name__ != "MappingEndEvent":
            self.plain(event)
            if type(event).__name__ != "ScalarEvent" or not event.value.isprintable():
                raise self.wrong(event, "has a key that is no word")
            if event.value in found:
                raise self.wrong(event, f"has the key {event.value[:60]!r} twice")
            found[event.value] = Entry(self.value(self.next(), depth + 1), event.start_mark.line + 1)
        return found

    def value(self, event: Any, depth: int) -> Any:
        if depth > _DEEPEST:
            raise self.wrong(event, f"has values nested deeper than {_DEEPEST}")
        matrix, kind = self.plain(event), type(event).__name__
        if kind == "MappingStartEvent":
            parts = self.mapping({}, depth)
            return self.matrix(event, parts) if matrix else parts
        if kind == "SequenceStartEvent":
            return self.sequence(depth)
        number = float(event.value) if _NUMBER.match(event.value) else math.nan
        return number if math.isfinite(number) else event.value

    def sequence(self, depth: int) -> list[Any]:
        data = []
        while type(event := self.next()).__name__ != "SequenceEndEvent":
            data.append(self.value(event, depth + 1))
        return data

    def matrix(self, event: Any, parts: Mapping[str, Entry]) -> np.ndarray[Any, Any]:
        rows, columns, sizes, data = (
            parts[key].value if key in parts else None for key in ("rows", "cols", "sizes", "data")
        )
        shape = sizes if isinstance(sizes, list) else [rows, columns]  # OpenCV 5 writes vectors by "sizes"
        if not (_numbers(data) and _numbers(shape) and math.prod(shape) == len(data)):
            raise self.wrong(event, "has a matrix whose rows, cols and data do not agree, or are no numbers")
        return np.array(data, dtype=np.float64).reshape([int(one) for one in shape])


def _numbers(value: Any) -> TypeGuard[list[float]]:
    return isinstance(value, list) and bool(value) and all(isinstance(one, float) for one in value)
