"""Ctrl-C: the first ends the run cleanly, a second ends the process."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import typer

__all__ = ["interruptible"]


@contextmanager
def interruptible() -> Iterator[threading.Event]:
    """An event that is set when Ctrl-C (or a polite kill) arrives."""
    cancel = threading.Event()

    def interrupt(signum: int, frame: FrameType | None) -> None:  # noqa: ARG001 - the form of a handler
        if cancel.is_set():
            os._exit(130)
        cancel.set()
        typer.echo("interrupted: ending after the node at work; once more ends at once", err=True)

    before = {which: signal.signal(which, interrupt) for which in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield cancel
    finally:
        for which, handler in before.items():
            signal.signal(which, handler)
