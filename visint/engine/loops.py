"""Turn loops: bounded, watching their end condition, every stop with its reason."""

from __future__ import annotations

from typing import Any

from visint.engine.convergence import relative_change
from visint.engine.executors import Run
from visint.engine.feedback import begin, carry
from visint.engine.frame import Frame
from visint.engine.state import State
from visint.errors import ModuleError, Problem
from visint.events import LoopEnded, TurnFinished, Warned
from visint.results import records
from visint.schedule import Repeat

__all__ = ["Turns"]


_tuple = tuple.__new__
"""Makes a named tuple in a third of the time that calling its class takes."""


class Turns:
    """A turn loop made ready to run."""

    def __init__(self, repeat: Repeat, body: Run, restarts: tuple[int, ...]) -> None:
        self._repeat = repeat
        self._body = body
        self._restarts = restarts
        self._until = repeat.loop.until.spec if repeat.loop.until else None
        self._times = repeat.loop.spec.times or 1

    def __call__(self, state: State, frame: Frame) -> None:
        """Goes round until the loop ends.

        Raises
        ------
        ModuleError
            VI404 if the bound is reached first and the loop says ``on_exhausted: fail``.
        """
        before: Any = None
        calm = 0
        reason: records.Reason = "exhausted" if self._until else "times"
        turn, name = 0, self._repeat.loop.name
        begin(state, self._repeat.cells, frame)
        for turn in range(self._times):
            for slot in self._restarts:  # of loops inside: none of them is one of this loop's cells
                state.begun.pop(slot, None)
            self._body(state, _tuple(Frame, (frame.level, frame.size, (*frame.turns, turn))))
            carry(state, self._repeat.cells, frame.level)
            change = None
            if self._repeat.change is not None:
                change = self._change(state, frame, turn, before)
                before = state.slots[self._repeat.change]
                calm = calm + 1 if self._is_calm(change) else 0
            if state.emit is not None:
                state.emit(_tuple(TurnFinished, (state.within + name, frame.level, turn, change)))
            ended = self._ended(state, calm)
            if ended is not None:
                reason = ended
                break
        self._stop(state, frame, turn + 1, reason)

    def _change(self, state: State, frame: Frame, turn: int, before: Any) -> float | None:
        """What changed since the turn before; the first turn of a level never counts."""
        if self._repeat.change is None or turn == 0:
            return None
        change = relative_change(before, state.slots[self._repeat.change])
        name = state.within + self._repeat.loop.name
        state.record.turns.append(records.Turn(name, frame.level, turn, change))
        return change

    def _is_calm(self, change: float | None) -> bool:
        assert self._until is not None
        return change is not None and self._until.below is not None and change < self._until.below

    def _ended(self, state: State, calm: int) -> records.Reason | None:
        if self._until is None:
            return None
        if self._repeat.holds is not None and state.slots[self._repeat.holds]:
            return "held"
        return "converged" if calm >= self._until.patience and self._repeat.change is not None else None

    def _stop(self, state: State, frame: Frame, turns: int, reason: records.Reason) -> None:
        name = state.within + self._repeat.loop.name
        state.record.stops.append(records.Stop(name, frame.level, turns, reason))
        if state.emit is not None:
            state.emit(LoopEnded(name, frame.level, turns, reason))
        if reason != "exhausted":
            return
        said = f"the loop {name!r} went round {turns} times at level {frame.level} without ending"
        if self._repeat.loop.spec.on_exhausted == "fail":
            problem = Problem("VI404", said, write="on_exhausted: accept, or more times", fault="graph")
            raise ModuleError(problem)
        if self._repeat.loop.spec.on_exhausted == "warn":
            state.record.warnings.append(records.Warned(name, frame.level, turns - 1, "exhausted", said))
            state.tell(Warned(name, frame.level, turns - 1, "exhausted", said))
