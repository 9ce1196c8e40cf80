"""Profile: an observer that keeps every call, for a table and for a timeline."""

from __future__ import annotations

import threading
from collections import defaultdict
from typing import Any, NamedTuple

from visint.events import Event, NodeFinished

__all__ = ["Line", "Profile", "Row"]


class Row(NamedTuple):
    """One call: when it began (``perf_counter``), how long it took, on which thread."""

    node: str
    level: int
    turn: int
    clock: float
    seconds: float
    thread: int


class Line(NamedTuple):
    """All calls of a node at a level: how many, how long together, and the longest of them."""

    node: str
    level: int
    calls: int
    seconds: float
    longest: float


class Profile:
    """Give it to a run as an observer; afterwards :attr:`rows` holds every call in order."""

    def __init__(self) -> None:
        self.rows: list[Row] = []

    def __call__(self, event: Event) -> None:
        """Takes note of finished nodes."""
        if isinstance(event, NodeFinished):
            self.rows.append(Row(*event[:5], threading.get_ident()))

    def table(self) -> list[Line]:
        """One line a node and level, the dearest first."""
        seconds: dict[tuple[str, int], list[float]] = defaultdict(list)
        for row in self.rows:
            seconds[row.node, row.level].append(row.seconds)
        lines = [Line(*place, len(each), sum(each), max(each)) for place, each in seconds.items()]
        return sorted(lines, key=lambda line: line.seconds, reverse=True)

    def chrome(self) -> dict[str, Any]:
        """The timeline in Chrome's trace-event format, times in microseconds; open it in ``chrome://tracing``."""
        start = min((row.clock for row in self.rows), default=0.0)
        threads = {ident: i for i, ident in enumerate(dict.fromkeys(row.thread for row in self.rows))}
        return {
            "displayTimeUnit": "ms",
            "traceEvents": [
                {
                    "name": row.node,
                    "ph": "X",
                    "ts": round((row.clock - start) * 1e6, 1),
                    "dur": round(row.seconds * 1e6, 1),
                    "pid": 0,
                    "tid": threads[row.thread],
                    "args": {"level": row.level, "turn": row.turn},
                }
                for row in self.rows
            ],
        }
