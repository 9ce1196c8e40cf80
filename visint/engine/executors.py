"""Blocks at work: items one after the other, or side by side where they do not wait for each other."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from visint.engine.frame import Frame
from visint.engine.state import State
from visint.schedule import Block

__all__ = ["Run", "in_order", "side_by_side"]

Run = Callable[[State, Frame], None]


def in_order(block: Block, items: list[Run]) -> Run:
    """The serial executor: items in the order of the schedule, values let go after their last reader."""
    plan = tuple(zip(items, block.frees, strict=True))

    def run(state: State, frame: Frame) -> None:
        slots = state.slots
        for item, frees in plan:
            item(state, frame)
            for slot in frees:
                slots[slot] = None

    return run


def side_by_side(block: Block, items: list[Run], pool: int) -> Run:
    """The threads executor: an item starts as soon as those it waits for are done, in that pool of the state.

    Modules are functions of their inputs, so the results are the same bits as in order. Values are let go
    at the end of the block: which reader is the last is not known before.
    """
    if len(items) < 2 or all(len(after) == i for i, after in enumerate(block.after)):
        return in_order(block, items)

    def run(state: State, frame: Frame) -> None:
        _run_all(block, items, state.pools[pool], state, frame)
        for frees in block.frees:
            for slot in frees:
                state.slots[slot] = None

    return run


def _run_all(block: Block, items: list[Run], pool: ThreadPoolExecutor, state: State, frame: Frame) -> None:
    waiting = {i: set(after) for i, after in enumerate(block.after)}
    running: dict[Future[None], int] = {}
    try:
        while waiting or running:
            for i in [i for i, after in waiting.items() if not after]:
                del waiting[i]
                running[pool.submit(items[i], state, frame)] = i
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for i, future in _sorted(running, done):
                future.result()
                for after in waiting.values():
                    after.discard(i)
    finally:
        wait(running)


def _sorted(running: dict[Future[None], int], done: set[Future[None]]) -> list[tuple[int, Future[None]]]:
    """Finished items in the order of the schedule, so that of two failures the same one is told each time."""
    return sorted(((running.pop(future), future) for future in done), key=lambda pair: pair[0])
