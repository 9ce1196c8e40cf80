"""Ctrl-C: the first ends the run cleanly, a second ends the process. A polite kill is a Ctrl-C."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

import typer

__all__ = ["interruptible", "undoable"]


@contextmanager
def interruptible() -> Iterator[threading.Event]:
    """While nothing is written: an event that is set when the run shall end."""
    cancel = threading.Event()

    def interrupt() -> None:
        if cancel.is_set():
            os._exit(130)
        cancel.set()
        typer.echo("interrupted: ending after the node at work; once more ends at once", err=True)

    with _on_signals(interrupt):
        yield cancel


@contextmanager
def undoable() -> Iterator[None]:
    """While files are written: KeyboardInterrupt, so that what is half-written goes away."""

    def interrupt() -> None:
        raise KeyboardInterrupt

    with _on_signals(interrupt):
        yield


@contextmanager
def _on_signals(interrupt: Callable[[], None]) -> Iterator[None]:
    def handle(signum: int, frame: FrameType | None) -> None:  # noqa: ARG001 - the form of a handler
        interrupt()

    mine = threading.current_thread() is threading.main_thread()  # no other one may listen
    caught = (signal.SIGINT, signal.SIGTERM) if mine else ()
    before = {which: signal.signal(which, handle) for which in caught}
    try:
        yield
    finally:
        for which, handler in before.items():
            signal.signal(which, handler)
