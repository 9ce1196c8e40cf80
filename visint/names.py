"""Names: of modules (``stereo.weng``), of ports (``match.left``), and the nearest one when one is wrong."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from typing import NamedTuple

__all__ = ["ModuleId", "PortRef", "did_you_mean", "is_name", "listed"]

_NAME = re.compile(r"[a-z][a-z0-9_]*\Z", re.ASCII)
_LONGEST = 64


def is_name(text: str) -> bool:
    """Whether ``text`` may name a node, a port, a loop or a graph: ``[a-z][a-z0-9_]*``, at most 64."""
    return len(text) <= _LONGEST and _NAME.match(text) is not None


class ModuleId(NamedTuple):
    """``plugin.name``: the entry point that brings the module, and the module's own name."""

    plugin: str
    name: str

    @classmethod
    def parse(cls, text: str) -> ModuleId | None:
        """The id spelled by ``text``, or None if it spells none."""
        plugin, dot, name = text.partition(".")
        return cls(plugin, name) if dot and is_name(plugin) and is_name(name) else None

    def __str__(self) -> str:
        return f"{self.plugin}.{self.name}"


class PortRef(NamedTuple):
    """``node.port``: where an edge comes from. ``inputs`` and ``map`` are nodes that every graph may have."""

    node: str
    port: str

    @classmethod
    def parse(cls, text: str) -> PortRef | None:
        """The reference spelled by ``text``, or None if it spells none."""
        node, dot, port = text.partition(".")
        return cls(node, port) if dot and is_name(node) and is_name(port) else None

    def __str__(self) -> str:
        return f"{self.node}.{self.port}"


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """The member of ``known`` that ``word`` most likely meant, or None if none is near."""
    near = difflib.get_close_matches(word, sorted(known), n=1, cutoff=0.6)
    return near[0] if near else None


def listed(words: Iterable[str], none: str = "none") -> str:
    """``words`` as a phrase for a message, in order: ``a, b, c`` or ``none``."""
    return ", ".join(words) or none
