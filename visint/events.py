"""What observers receive: progress, profile, live view and run record are all made of these.

An observer is a callable of one event. Events are made only when somebody listens; numbers about arrays are
computed only when an observer asks (:meth:`NodeFinished.summary`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeAlias

__all__ = [
    "Assumed",
    "Event",
    "LevelStarted",
    "LoopEnded",
    "Measured",
    "NodeFailed",
    "NodeFinished",
    "NodeStarted",
    "Observer",
    "RunFinished",
    "RunStarted",
    "TurnFinished",
    "Warned",
]


class RunStarted(NamedTuple):
    """The run begins. ``nodes`` are in the order of the schedule, ``calls`` is the most calls of ``run``."""

    graph: str
    nodes: tuple[str, ...]
    calls: int


class NodeStarted(NamedTuple):
    """A node is about to run; ``clock`` is seconds of ``time.perf_counter``."""

    node: str
    level: int
    turn: int
    clock: float


class NodeFinished(NamedTuple):
    """A node has run in ``seconds``; ``outputs`` are its values by port, not to be kept."""

    node: str
    level: int
    turn: int
    clock: float
    seconds: float
    outputs: Mapping[str, Any]

    def summary(self) -> Mapping[str, str]:
        """A few words an output port: type, shape, range of the known. Costs a pass over the arrays."""
        return {name: _summary(value) for name, value in self.outputs.items()}


class NodeFailed(NamedTuple):
    """A node raised; the run ends."""

    node: str
    level: int
    turn: int
    error: str


class LevelStarted(NamedTuple):
    """A pyramid begins a level of ``size`` (rows, columns)."""

    loop: str
    level: int
    size: tuple[int, int]


class TurnFinished(NamedTuple):
    """A turn loop has gone round; ``change`` is what its ``until`` measured, None if it has none."""

    loop: str
    level: int
    turn: int
    change: float | None


class LoopEnded(NamedTuple):
    """A loop ended after ``turns``; ``reason`` is ``times``, ``converged``, ``held`` or ``exhausted``."""

    loop: str
    level: int
    turns: int
    reason: str


class Measured(NamedTuple):
    """A module recorded a number (``ctx.measure``)."""

    node: str
    level: int
    turn: int
    name: str
    value: float


class Assumed(NamedTuple):
    """A module said where a premise of its held (``ctx.assumed``).

    ``held`` is a bool for the whole image (then ``regions`` is None), or bool by label of ``regions``.
    """

    node: str
    level: int
    turn: int
    name: str
    held: Any
    regions: Any


class Warned(NamedTuple):
    """A module, or the engine, has something to say (``ctx.warn``)."""

    node: str
    level: int
    turn: int
    code: str
    text: str


class RunFinished(NamedTuple):
    """The run ended after ``seconds``; ``failed`` says whether by an error."""

    graph: str
    seconds: float
    failed: bool


Event: TypeAlias = (
    RunStarted
    | NodeStarted
    | NodeFinished
    | NodeFailed
    | LevelStarted
    | TurnFinished
    | LoopEnded
    | Measured
    | Assumed
    | Warned
    | RunFinished
)
Observer: TypeAlias = Callable[[Event], None]


def _summary(value: Any) -> str:
    import numpy as np

    if isinstance(value, tuple):
        return f"{len(value)} × {_summary(value[0])}" if value else "0 values"
    value = getattr(value, "value", value)
    if not isinstance(value, np.ndarray):
        return f"{value:g}" if type(value) in (int, float) else _named(value)
    text = f"{value.dtype} {value.shape}"
    if value.dtype.kind == "b":
        return f"{text} {np.count_nonzero(value)} set"
    finite = value[np.isfinite(value)]
    return f"{text} {finite.min():.4g}..{finite.max():.4g}" if finite.size else f"{text} nothing known"


def _named(value: object) -> str:
    return "none" if value is None else str(value) if isinstance(value, bool) else type(value).__name__
