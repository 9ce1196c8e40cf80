"""How a run is to be done, apart from what is run on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from threading import Event
from typing import Any

from visint.errors import UsageError
from visint.events import Observer

__all__ = ["Options"]


@dataclass(frozen=True, slots=True)
class Options:
    """Options of :func:`visint.run`.

    Raises UsageError VI701 for a wrong number of threads.

    Parameters
    ----------
    seed
        What random numbers follow from, together with each node's place in the graph.
    threads
        1 runs node after node; more lets nodes that do not wait for each other run side by side. The
        results are the same bits.
    stop_after
        The name of a node after which the run ends; loops around it run to their end. What the node gives is
        among the outputs, as ``NODE_PORT``.
    start
        Fields of the map to start from, by name, at full size: a warm start. ``<field>_confidence`` too.
    observers
        Callables that receive every event.
    attribution
        Follow which cue decided each field of the map, into ``Result.attribution``: some milliseconds a commit
        of 512 × 512 pixels. False costs nothing.
    cancel
        Set it from another thread to interrupt the run.
    """

    seed: int = 0
    threads: int = 1
    stop_after: str | None = None
    start: Mapping[str, Any] = field(default_factory=dict)
    observers: tuple[Observer, ...] = ()
    attribution: bool = False
    cancel: Event = field(default_factory=Event)

    def __post_init__(self) -> None:
        if type(self.threads) is not int or self.threads < 1:
            found = f"threads is a whole number from 1 on; this is {self.threads!r}"
            raise UsageError.of("VI701", found, write="threads=1")
