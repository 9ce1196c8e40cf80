"""A spec as the text of a graph file: readable, and read back equal."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from visint.graph.spec import GraphSpec

__all__ = ["as_written", "to_yaml"]

_WIDE = 100
_BARE = re.compile(r"[A-Za-z_/][A-Za-z0-9_./?:-]*(?<!:)\Z")
_NOT_FINITE = {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}
_WORDS = frozenset({"null", "true", "false", "~", "yes", "no", "on", "off"})


def to_yaml(spec: GraphSpec) -> str:
    """``spec`` as YAML: short mappings on one line, long ones a line a key, in the spec's order."""
    return "".join(f"{line}\n" for line in _mapping(spec.plain(), 0))


def _mapping(data: Mapping[Any, Any], indent: int) -> Iterator[str]:
    for key, value in data.items():
        head = f"{' ' * indent}{_scalar(key)}:"
        flow = _flow(value)
        if isinstance(value, Mapping) and value and (indent == 0 or len(head) + len(flow) >= _WIDE):
            yield head
            yield from _mapping(value, indent + 2)
        else:
            yield f"{head} {flow}"


def as_written(value: Any) -> str:
    """A value as a line to paste has it; long ones are cut to a sign that there was more."""
    text = _flow(value)
    if len(text) <= _WIDE:
        return text
    return "{…}" if isinstance(value, dict) else "[…]" if isinstance(value, list) else "…"


def _flow(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_scalar(key)}: {_flow(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_flow(one) for one in value) + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return _NOT_FINITE.get(repr(value), repr(value))
    text = str(value)
    if _BARE.match(text) and text.lower() not in _WORDS:
        return text
    return _quoted(text)


def _quoted(text: str) -> str:
    escaped = "".join(
        char if char.isprintable() and char not in '"\\' else f"\\U{ord(char):08x}" for char in text
    )
    return f'"{escaped}"'
