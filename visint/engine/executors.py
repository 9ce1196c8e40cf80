"""Blocks at work: items one after the other, or side by side where they do not wait for each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from visint.engine.frame import Frame
from visint.engine.state import State
from visint.errors import Cancelled
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

    Modules are functions of their inputs, so the results are the same bits as in order. A value is let go
    when all items up to its last reader are done. Of several failures the one is told that comes first in
    order: what stands before a failure is still done, what stands after it is not begun.
    """
    if len(items) < 2 or all(len(after) == i for i, after in enumerate(block.after)):
        return in_order(block, items)
    return lambda state, frame: _Going(block, items, state, frame).through(
        state.pools[pool], outermost=pool == 0
    )


class _Going:
    """One going through a block: which items wait, run, are done or have failed."""

    def __init__(self, block: Block, items: list[Run], state: State, frame: Frame) -> None:
        self._block = block
        self._items = items
        self._state = state
        self._frame = frame
        self._waiting = {i: set(after) for i, after in enumerate(block.after)}
        self._running: dict[Future[None], int] = {}
        self._failures: dict[int, BaseException] = {}
        self._done: set[int] = set()
        self._let_go = 0

    def through(self, pool: ThreadPoolExecutor, *, outermost: bool) -> None:
        try:
            while self._begin(pool, outermost=outermost):
                for future in wait(self._running, return_when=FIRST_COMPLETED).done:
                    self._ended(self._running.pop(future), future)
        except BaseException:  # Ctrl-C in the thread that waits: the others must not go on for hours
            self._state.cancel.set()
            wait(self._running)
            raise
        if self._failures:
            raise self._told()

    def _begin(self, pool: ThreadPoolExecutor, *, outermost: bool) -> bool:
        """Starts what waits for nothing any more; says whether anything is at work."""
        end = min(self._failures, default=len(self._items))
        for i in [i for i, after in self._waiting.items() if not after and i < end]:
            del self._waiting[i]
            self._running[pool.submit(self._items[i], self._state, self._frame)] = i
        if outermost and self._running and min(self._running.values()) > end:
            self._state.cancel.set()  # nothing at work can still matter
        return bool(self._running)

    def _ended(self, i: int, future: Future[None]) -> None:
        if future.cancelled():
            return
        error = future.exception()
        if error is None:
            self._done.add(i)
            for after in self._waiting.values():
                after.discard(i)
            self._free()
            return
        self._failures[i] = error
        for other in self._after(i):
            other.cancel()
        if not isinstance(error, Exception):
            self._state.cancel.set()

    def _after(self, i: int) -> Iterator[Future[None]]:
        return (future for future, j in self._running.items() if j > i)

    def _free(self) -> None:
        """Lets go what no item can read any more: the last reader and all items before it are done."""
        while self._let_go in self._done:
            for slot in self._block.frees[self._let_go]:
                self._state.slots[slot] = None
            self._let_go += 1

    def _told(self) -> BaseException:
        """The failure that running in order would have met; Ctrl-C before all, being cancelled after all."""

        def rank(i: int) -> tuple[bool, bool, int]:
            error = self._failures[i]
            return isinstance(error, Exception), isinstance(error, Cancelled), i

        return self._failures[min(self._failures, key=rank)]
