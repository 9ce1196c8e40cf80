"""What a run leaves on record beside its maps: turns, stops, warnings, measures, timings."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

__all__ = ["Assumed", "Measure", "Reason", "Record", "Stop", "Timing", "Turn", "Warned"]

Reason = Literal["times", "converged", "held", "exhausted"]


class Turn(NamedTuple):
    """One turn of a loop that watches its convergence; ``change`` is NaN where nothing could be compared."""

    loop: str
    level: int
    turn: int
    change: float


class Stop(NamedTuple):
    """Why a loop ended: all its ``times``, ``converged``, ``held``, or ``exhausted`` without ending."""

    loop: str
    level: int
    turns: int
    reason: Reason


class Warned(NamedTuple):
    """Something a module or the engine had to say."""

    node: str
    level: int
    turn: int
    code: str
    text: str


class Measure(NamedTuple):
    """A number a module recorded."""

    node: str
    level: int
    turn: int
    name: str
    value: float


class Assumed(NamedTuple):
    """What a module said last of a premise of its, at the finest level it spoke at.

    ``held`` is a bool for the whole image of ``size`` (rows, columns), or bool by label of ``regions``.
    """

    node: str
    level: int
    turn: int
    name: str
    held: Any
    regions: Any
    size: tuple[int, int] | None


class Timing(NamedTuple):
    """Calls and seconds of a node at a level."""

    node: str
    level: int
    calls: int
    seconds: float


@dataclass(slots=True)
class Record:
    """Everything of the above, as one run fills it; where it was told to stop, and the map it started from."""

    turns: list[Turn] = field(default_factory=list)
    stops: list[Stop] = field(default_factory=list)
    warnings: list[Warned] = field(default_factory=list)
    measures: list[Measure] = field(default_factory=list)
    assumed: dict[tuple[str, str], Assumed] = field(default_factory=dict)
    stop_after: str | None = None
    start: Mapping[str, Any] = field(default_factory=dict)
    seconds: dict[tuple[str, int], list[float]] = field(default_factory=lambda: defaultdict(lambda: [0, 0.0]))

    def timings(self) -> Iterator[Timing]:
        """Calls and seconds by node and level, in the order of first calls."""
        for (node, level), (calls, seconds) in self.seconds.items():
            yield Timing(node, level, int(calls), seconds)

    def note_assumed(self, said: Assumed) -> None:
        """Keeps ``said`` in place of what was said before, unless that was at a finer level."""
        before = self.assumed.get((said.node, said.name))
        if before is None or said.level <= before.level:
            self.assumed[said.node, said.name] = said

    def in_order(self, loops: Iterable[str], nodes: Iterable[str]) -> None:
        """Sorts by loop and by node, keeping the order of time within each: threads may have mixed them.

        What happened in a sub-graph, ``call.node``, stands where its call does.
        """
        rank = {name: i for i, name in enumerate([*loops, *nodes])}

        def place(name: str) -> int:
            return rank.get(name.partition(".")[0], len(rank))

        self.turns.sort(key=lambda turn: place(turn.loop))
        self.stops.sort(key=lambda stop: place(stop.loop))
        self.warnings.sort(key=lambda warned: place(warned.node))
        self.measures.sort(key=lambda measure: place(measure.node))
        assumed = sorted(self.assumed.items(), key=lambda each: place(each[0][0]))
        self.assumed.clear()
        self.assumed.update(assumed)
        seconds = sorted(self.seconds.items(), key=lambda each: place(each[0][0]))
        self.seconds.clear()
        self.seconds.update(seconds)
