"""Levels: a pyramid from coarse to fine, and the values from outside fitted to each level."""

from __future__ import annotations

from typing import Any

from visint.engine.executors import Run
from visint.engine.feedback import begin, carry, coarser, to_level
from visint.engine.frame import Frame
from visint.engine.state import State
from visint.errors import InputError
from visint.events import LevelStarted, LoopEnded
from visint.fields.resampling import levels_down_to, smaller
from visint.results import records
from visint.schedule import Pyramid

__all__ = ["Levels"]


class Levels:
    """A pyramid made ready to run."""

    def __init__(self, pyramid: Pyramid, body: Run, restarts: tuple[int, ...]) -> None:
        self._pyramid = pyramid
        self._body = body
        self._restarts = restarts

    def __call__(self, state: State, frame: Frame) -> None:
        """Runs the body once a level, coarsest first.

        Raises
        ------
        InputError
            If the run has no image to take a size from.
        """
        name = state.within + self._pyramid.loop.name
        sizes = self._sizes(frame)
        fitted = [self._pyramid_of(state.slots[fit.source], fit.kind, len(sizes)) for fit in self._pyramid.fits]
        for level in reversed(range(len(sizes))):
            inner = Frame(level, sizes[level], frame.turns)
            if state.emit is not None:
                state.emit(LevelStarted(name, level, sizes[level]))
            for fit, values in zip(self._pyramid.fits, fitted, strict=True):
                state.slots[fit.slot] = values[level]
                values[level] = None
            for slot in self._restarts:
                state.begun.pop(slot, None)
            to_level(state, self._pyramid.carried, level, sizes, self._pyramid.loop.spec.between)
            begin(state, self._pyramid.cells, inner)
            self._body(state, inner)
            carry(state, self._pyramid.cells, level)
        state.record.stops.append(records.Stop(name, 0, len(sizes), "times"))
        if state.emit is not None:
            state.emit(LoopEnded(name, 0, len(sizes), "times"))

    def _sizes(self, frame: Frame) -> list[tuple[int, int]]:
        if frame.size is None:
            found = f"the pyramid {self._pyramid.loop.name!r} needs an image among the graph's inputs"
            raise InputError.of("VI305", found)
        spec = self._pyramid.loop.spec
        count = spec.levels or levels_down_to(frame.size, spec.coarsest or 1)
        sizes = [frame.size]
        for _ in range(count - 1):
            sizes.append(smaller(sizes[-1]))
        return sizes

    def _pyramid_of(self, value: Any, kind: Any, count: int) -> list[Any]:
        """``value`` at each level, full size first."""
        values = [value]
        for _ in range(count - 1):
            values.append(coarser(values[-1], kind))
        return values
