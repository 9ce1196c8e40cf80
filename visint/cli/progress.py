"""A progress bar for runs that take more than a second."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from visint.events import Event, NodeFinished, NodeStarted, Observer, RunStarted

if TYPE_CHECKING:
    from rich.progress import Progress

__all__ = ["progress"]

_PATIENCE = 1.0
"""Seconds before the bar is shown: what is done by then needs none."""


@contextmanager
def progress(*, quiet: bool) -> Iterator[Observer | None]:
    """An observer that draws a bar on stderr; None where nobody would see it."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description:28}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    bar = _Bar(Progress(*columns, console=Console(stderr=True), transient=True))
    try:
        yield bar
    finally:
        bar.close()


class _Bar:
    """Turns events into the state of a bar. A clock of its own shows it: a slow node tells of nothing."""

    def __init__(self, bar: Progress) -> None:
        self._bar = bar
        self._task = bar.add_task("starting", total=None)
        self._clock = threading.Timer(_PATIENCE, bar.start)
        self._clock.daemon = True
        self._clock.start()

    def __call__(self, event: Event) -> None:
        if isinstance(event, RunStarted):
            self._bar.update(self._task, total=event.calls)
        elif isinstance(event, NodeStarted):
            self._bar.update(self._task, description=f"{event.node} (level {event.level})")
        elif isinstance(event, NodeFinished):
            self._bar.advance(self._task)

    def close(self) -> None:
        self._clock.cancel()
        self._clock.join()
        if self._bar.live.is_started:
            self._bar.stop()
