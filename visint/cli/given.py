"""What a command line gives as inputs: files and texts by the names that the graph has for them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from visint.errors import UsageError

if TYPE_CHECKING:
    from visint.graph import Graph
    from visint.results import Source

__all__ = ["Given", "pair", "settings"]

_TEXTS = ("Light", "Scalar", "Flag", "Text")


class Given(NamedTuple):
    """The options of a run that stand for inputs, as they were typed."""

    left: str
    right: str
    calib: str
    light: str
    light_at: str
    disparity_range: str
    others: tuple[str, ...]
    gamma: float | None

    def sources(self, graph: Graph) -> dict[str, Source]:
        """Where the inputs of ``graph`` come from, paths made absolute.

        Raises
        ------
        UsageError
            VI701 for what excludes each other, and for an ``--in`` that is not NAME=PATH.
        """
        found: dict[str, Source] = {}
        for name, source in self._named(graph):
            before = found.get(name, source._replace(paths=(), text=""))
            found[name] = source._replace(paths=(*before.paths, *source.paths), text=source.text or before.text)
        return found

    def _named(self, graph: Graph) -> Iterator[tuple[str, Source]]:
        from visint.results import Source

        if self.left:
            yield "left", Source((_absolute(self.left),), gamma=self.gamma)
        if self.right:
            yield "right", Source((_absolute(self.right),), gamma=self.gamma)
        if self.calib or self.disparity_range:
            yield "camera", Source((_absolute(self.calib),) if self.calib else (), self.disparity_range)
        if self.light and self.light_at:
            raise UsageError.of("VI701", "--light and --light-at exclude each other")
        if self.light or self.light_at:
            yield "light", Source((), self.light or f"at {self.light_at}")
        for text in self.others:
            name, value = pair(text, "--in NAME=PATH")
            kind = graph.inputs[name].kind if name in graph.inputs else ""
            gamma = self.gamma if kind in ("Image", "Color") else None
            yield name, Source((), value) if kind in _TEXTS else Source((_absolute(value),), "", gamma)


def _absolute(path: str) -> str:
    return str(Path(path).absolute())


def pair(text: str, wanted: str) -> tuple[str, str]:
    """Name and value of ``NAME=VALUE``; UsageError VI701 says what is ``wanted`` instead."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise UsageError.of("VI701", f"{text!r} is not of the form {wanted}")
    return name, value


def settings(given: list[str]) -> dict[str, Any]:
    """``node.param=value``; values are read as in a graph file."""
    from visint.graph.read import parse_value

    pairs = (pair(text, "--set NODE.PARAM=VALUE") for text in given)
    return {key: parse_value(value) for key, value in pairs}
