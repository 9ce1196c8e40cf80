"""YAML 1.2 (or JSON) to plain data, with the place of every key and value.

ruamel only splits the text into events. Tags, anchors, aliases and merge keys are refused as they come.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from visint.errors import GraphError, Problem, Where
from visint.graph.limits import DEEPEST, LONGEST, LONGEST_TEXT, refuse_monsters
from visint.graph.syntax import not_well_formed

__all__ = ["Places", "compose"]

Path = tuple[str | int, ...]


class Mark(NamedTuple):
    """Line and column, from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Places:
    """Where in a file the value, and the key, of each path of keys stands."""

    file: str
    values: Mapping[Path, Mark] = field(default_factory=dict)
    keys: Mapping[Path, Mark] = field(default_factory=dict)

    def where(self, *path: str | int, key: bool = False) -> Where:
        """The place of ``path``, or of the nearest thing above it that stands in the file.

        What lacks something is pointed at by its key: its value may begin on another line, or be nowhere.
        """
        for length in range(len(path), -1, -1):
            by_key = length and (key or length < len(path))
            mark = (self.keys if by_key else self.values).get(path[:length])
            if mark is not None:
                return Where(self.file, mark.line, mark.column, ".".join(map(str, path)))
        return Where(self.file, path=".".join(map(str, path)))


def compose(text: str, file: str) -> tuple[Any, Places]:
    """The data in ``text`` and where its parts stand.

    Raises
    ------
    GraphError
        VI102 to VI105 and VI107.
    """
    text = text.removeprefix("\ufeff")
    refuse_monsters(text, file)
    if text.lstrip()[:1] in ("{", "["):  # JSON may be indented by tabs, which it allows nowhere else
        text = text.replace("\t", " ")
    composer = _Composer(text, file)
    return composer.document(), Places(file, composer.values, composer.keys)


_INT = re.compile(r"[-+]?[0-9]{1,18}\Z")
_OTHER_INT = re.compile(r"0(o[0-7]{1,18}|x[0-9a-fA-F]{1,15})\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_WORDS: Mapping[str, Any] = (
    dict.fromkeys(("", "~", "null", "Null", "NULL"))
    | dict.fromkeys(("true", "True", "TRUE"), True)
    | dict.fromkeys(("false", "False", "FALSE"), False)
    | dict.fromkeys((".inf", ".Inf", ".INF", "+.inf", "+.Inf", "+.INF"), math.inf)
    | dict.fromkeys(("-.inf", "-.Inf", "-.INF"), -math.inf)
    | dict.fromkeys((".nan", ".NaN", ".NAN"), math.nan)
)


def _plain(text: str) -> Any:
    """A plain scalar by the core schema of YAML 1.2 (so ``1e-4`` is a number and ``no`` is text)."""
    if text in _WORDS:
        return _WORDS[text]
    if _INT.match(text):
        return int(text)
    if _OTHER_INT.match(text):
        return int(text, 0)
    if _FLOAT.match(text) and math.isfinite(float(text)):
        return float(text)
    return text


class _Composer:
    """Builds plain data from parse events, minding the limits and keeping the places."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        self.values: dict[Path, Mark] = {(): Mark(1, 1)}
        self.keys: dict[Path, Mark] = {}
        self._count = 0

    def document(self) -> Any:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import YAMLError

        try:
            self._events: Iterator[Any] = iter(YAML(typ="safe", pure=True).parse(self.text))
            return self._document()
        except (YAMLError, ArithmeticError, AttributeError, AssertionError, LookupError, ValueError) as error:
            # ruamel's own, and what it lets through: chr() of a huge escape, indices beyond the end
            raise GraphError(not_well_formed(error, self.file)) from None

    def _document(self) -> Any:
        self._next()  # the stream begins
        if type(self._next()).__name__ == "StreamEndEvent":
            return None
        data = self._value(self._next(), ())
        self._next()  # the document ends
        if type(extra := self._next()).__name__ == "DocumentStartEvent":
            found = "a graph file holds one document; a second begins here"
            raise self._error("VI105", found, extra, (), "(each graph in a file of its own)")
        return data

    def _next(self) -> Any:
        event = next(self._events)
        self._count += 1
        if self._count > LONGEST:
            raise self._error("VI107", f"more than {LONGEST} values", event, ())
        return event

    def _value(self, event: Any, path: Path) -> Any:
        self.values[path] = _mark(event)
        self._plain_yaml(event, path)
        if len(path) > DEEPEST:
            found = f"values nested deeper than {DEEPEST}"
            raise self._error("VI107", found, event, path[:3], "key: value   (graphs are flat)")
        kind = type(event).__name__
        if kind == "MappingStartEvent":
            return self._mapping(path)
        if kind == "SequenceStartEvent":
            return self._sequence(path)
        return self._scalar(event, path)

    def _mapping(self, path: Path) -> dict[Any, Any]:
        data: dict[Any, Any] = {}
        while type(event := self._next()).__name__ != "MappingEndEvent":
            key = self._key(event, path)
            if key in data:
                first = self.keys[*path, key].line
                found = f"the key {key!r} stands twice; it stands in line {first} already"
                raise self._error("VI104", found, event, (*path, key), f"{key}: …   (once)")
            self.keys[*path, key] = _mark(event)
            data[key] = self._value(self._next(), (*path, key))
        return data

    def _key(self, event: Any, path: Path) -> Any:
        self._plain_yaml(event, path)
        if type(event).__name__ != "ScalarEvent":
            raise self._error(
                "VI103", "a key is a word or a number, not a list or a mapping", event, path, "key: …"
            )
        key = self._scalar(event, path)
        if key == "<<":
            found, write = "graph files have no merge keys ('<<')", "(every key that it would bring)"
            raise self._error("VI103", found, event, path, write)
        if isinstance(key, str) and not (key.isprintable() and len(key) <= 100):
            raise self._error("VI105", "a key is a word of at most 100 letters", event, path, "key: …")
        return key

    def _sequence(self, path: Path) -> list[Any]:
        data: list[Any] = []
        while type(event := self._next()).__name__ != "SequenceEndEvent":
            data.append(self._value(event, (*path, len(data))))
        return data

    def _scalar(self, event: Any, path: Path) -> Any:
        if len(event.value) > LONGEST_TEXT:
            raise self._error("VI107", f"a text of more than {LONGEST_TEXT} letters", event, path)
        try:  # JSON spells a letter beyond U+FFFF as two escapes
            text = event.value.encode("utf-16", "surrogatepass").decode("utf-16")
        except UnicodeDecodeError:
            raise self._error(
                "VI102", "half of a pair of \\u escapes", event, path, '"…"   (without it)'
            ) from None
        return _plain(text) if event.implicit[0] else text

    def _plain_yaml(self, event: Any, path: Path) -> None:
        if type(event).__name__ == "AliasEvent":
            found = f"graph files have no aliases (*{event.anchor[:40]})"
            raise self._error("VI103", found, event, path, f"{_last(path)}…   (the value itself)")
        if getattr(event, "anchor", None):
            found = f"graph files have no anchors (&{event.anchor[:40]})"
            raise self._error("VI103", found, event, path, f"{_last(path)}{_alone(event)}")
        if getattr(event, "tag", None):
            found = f"graph files have no tags ({str(event.tag)[:60]})"
            raise self._error("VI103", found, event, path, f"{_last(path)}{_alone(event)}")

    def _error(self, code: str, found: str, event: Any, path: Path, write: str = "") -> GraphError:
        place = Where(self.file, *_mark(event), ".".join(map(str, path)))
        return GraphError(Problem(code, found, place, write=write))


def _mark(event: Any) -> Mark:
    return Mark(event.start_mark.line + 1, event.start_mark.column + 1)


def _last(path: Path) -> str:
    return f"{path[-1]}: " if path else ""


def _alone(event: Any) -> str:
    """A value as it would be written without tag or anchor."""
    kinds = {"MappingStartEvent": "{…}", "SequenceStartEvent": "[…]"}
    return kinds.get(type(event).__name__) or str(event.value)[:60]
