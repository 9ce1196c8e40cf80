"""Premises: which assumptions each module of a run rests on, and in which regions they held."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from visint.graph.graph import Graph
from visint.results.records import Assumed, Record

__all__ = ["WHOLE", "Premise", "premises"]

WHOLE = 0
"""Stands for the whole image where a module looked at no regions; labels of regions begin at 1."""

State = Literal["untested", "held", "violated", "mixed"]


@dataclass(frozen=True, slots=True)
class Premise:
    """One assumption of one node, as the module found it last, at the finest level it ran at.

    Attributes
    ----------
    held, violated
        Pixels by label of the regions (:data:`WHOLE` for the whole image); a region is in one or in none.
        Regions of no pixel are left out.
    level, turn
        When it was said; None if the module never said anything about it.
    """

    held: Mapping[int, int] = field(default_factory=dict)
    violated: Mapping[int, int] = field(default_factory=dict)
    level: int | None = None
    turn: int | None = None

    @property
    def state(self) -> State:
        """``held`` everywhere, ``violated`` everywhere, ``mixed``, or ``untested``."""
        if not self.held and not self.violated:
            return "untested"
        if self.held and self.violated:
            return "mixed"
        return "held" if self.held else "violated"

    @property
    def share(self) -> float:
        """The share in [0, 1] of the pixels looked at where it held; NaN where none was."""
        held, violated = sum(self.held.values()), sum(self.violated.values())
        return held / (held + violated) if held + violated else float("nan")

    def plain(self) -> dict[str, Any]:
        """As JSON has it: labels as text."""
        told: dict[str, Any] = {"state": self.state}
        if self.level is not None:
            told |= {"level": self.level, "turn": self.turn}
        for name, regions in (("held", self.held), ("violated", self.violated)):
            if regions:
                told[name] = {str(label): pixels for label, pixels in regions.items()}
        return told


def premises(graph: Graph, record: Record) -> dict[str, dict[str, Premise]]:
    """By node and name: every assumption that the node's module declares, and what else it spoke of.

    Nodes of a sub-graph are named ``call.node``, as everywhere on record.
    """
    found = {node: dict.fromkeys(names, Premise()) for node, names in _declared(graph)}
    for said in record.assumed.values():
        found.setdefault(said.node, {})[said.name] = _tallied(said)
    return found


def _declared(graph: Graph, within: str = "") -> Iterator[tuple[str, tuple[str, ...]]]:
    for name, node in graph.nodes.items():
        if node.callee.graph is not None:
            yield from _declared(node.callee.graph, f"{within}{name}.")
        elif node.callee.module is not None and node.callee.module.assumptions:
            yield f"{within}{name}", node.callee.module.assumptions


def _tallied(said: Assumed) -> Premise:
    if said.regions is None:
        pixels = {WHOLE: int(np.prod(said.size)) if said.size else 1}
        return Premise(pixels if said.held else {}, {} if said.held else pixels, said.level, said.turn)
    counts = np.bincount(said.regions.ravel().clip(0), minlength=1)[: len(said.held)]
    labels = [label for label in np.flatnonzero(counts).tolist() if label > 0]
    held = {label: int(counts[label]) for label in labels if said.held[label]}
    violated = {label: int(counts[label]) for label in labels if not said.held[label]}
    return Premise(held, violated, said.level, said.turn)
