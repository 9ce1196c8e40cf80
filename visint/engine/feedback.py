"""Feedback: what a value that goes round starts with, and how it is carried to the next turn or level."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from visint.arrays import read_only
from visint.engine.commit import plane
from visint.engine.frame import Frame
from visint.engine.state import State
from visint.errors import InputError
from visint.fields.kinds import FieldKind, Interpolation, down, up
from visint.fields.snapshot import MapSnapshot
from visint.module import PortSpec
from visint.schedule import Cell
from visint.schedule.steps import Start

__all__ = ["begin", "carry", "coarser", "to_level"]


def begin(state: State, cells: Iterable[Cell], frame: Frame) -> None:
    """Gives each cell that has no value yet its start."""
    for cell in cells:
        if cell.slot not in state.begun:
            state.slots[cell.slot] = _start(state, cell, frame)
            state.begun[cell.slot] = frame.level


def _start(state: State, cell: Cell, frame: Frame) -> Any:
    if isinstance(cell.start, Start):
        return state.slots[cell.start.slot]
    if cell.start is None:
        return None
    if cell.start == "plane":
        return _plane(cell.port, frame, state)
    if cell.port.array is None:
        return bool(cell.start) if cell.port.kind == "Flag" else cell.start
    return read_only(np.full(_size(cell.port, frame), cell.start, cell.port.array.dtype))


def _plane(port: PortSpec, frame: Frame, state: State) -> Any:
    camera = state.camera_at(frame.level)
    if camera is None:
        raise _no_size(port)
    return plane(port.kind, camera)


def _size(port: PortSpec, frame: Frame) -> tuple[int, int]:
    if frame.size is None:
        raise _no_size(port)
    return frame.size


def _no_size(port: PortSpec) -> InputError:
    found = f"the start of {port.name!r} needs a size, and the graph has no image among its inputs"
    return InputError.of("VI305", found)


def carry(state: State, cells: Iterable[Cell], level: int) -> None:
    """At the end of a turn: every cell whose source runs at this level gets what it holds, all at once."""
    slots, begun = state.slots, state.begun
    fed = [(c.slot, slots[c.source]) for c in cells if c.levels is None or level in c.levels]
    for slot, value in fed:
        slots[slot] = value
        begun[slot] = level


def to_level(
    state: State,
    cells: Iterable[Cell],
    level: int,
    sizes: list[tuple[int, int]],
    between: Mapping[str, Interpolation],
) -> None:
    """At the start of a level: every value that goes round is brought from its level to this one."""
    for cell in cells:
        at = state.begun.get(cell.slot)
        if at is None or at == level:
            continue
        value = state.slots[cell.slot]
        while at > level:
            at -= 1
            value = _finer(value, cell, sizes[at], between)
        while at < level:
            at += 1
            value = coarser(value, cell.carry)
        state.slots[cell.slot] = value
        state.begun[cell.slot] = level


def coarser(value: Any, kind: FieldKind) -> Any:
    """Any value of ``kind``, the map included, one level coarser."""
    return value.coarser() if isinstance(value, MapSnapshot) else down(value, kind)


def _finer(value: Any, cell: Cell, size: tuple[int, int], between: Mapping[str, Interpolation]) -> Any:
    if isinstance(value, MapSnapshot):
        return value.finer(size, between)
    return up(value, cell.carry, size, between.get(cell.carry.name))
