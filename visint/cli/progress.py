"""A progress bar for runs that take more than a second."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from visint.events import Event, LevelStarted, LoopEnded, NodeFinished, NodeStarted, Observer, RunStarted

__all__ = ["progress"]

_PATIENCE = 1.0
"""Seconds before the bar is shown: what is done by then needs none."""


@contextmanager
def progress(*, quiet: bool) -> Iterator[Observer | None]:
    """An observer that draws a bar on stderr; None where nobody would see it."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield None
        return
    columns = (TextColumn("{task.description:28}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=console, transient=True)
    try:
        yield _Bar(bar)
    finally:
        bar.stop()


class _Bar:
    """Turns events into the state of a bar."""

    def __init__(self, bar: object) -> None:
        from rich.progress import Progress

        assert isinstance(bar, Progress)
        self._bar = bar
        self._task = bar.add_task("starting", total=None)
        self._since = time.monotonic()

    def __call__(self, event: Event) -> None:
        if isinstance(event, RunStarted):
            self._bar.update(self._task, total=event.calls)
        elif isinstance(event, NodeStarted):
            self._bar.update(self._task, description=f"{event.node} (level {event.level})")
        elif isinstance(event, NodeFinished):
            self._bar.advance(self._task)
        elif isinstance(event, LoopEnded | LevelStarted):
            self._bar.refresh()
        if not self._bar.live.is_started and time.monotonic() - self._since > _PATIENCE:
            self._bar.start()
