"""Writes that fail, for tests: every step of every write passes here, and one of them can be told to fail.

As SQLite is tested: a run is done once to count its steps, then again for each of them with that step failing,
and each time nothing half-written may be left and the next run must give the same bytes.
"""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator
from typing import Literal

__all__ = ["Faults", "cut", "failing", "step"]

Kind = Literal["ENOSPC", "EIO", "EACCES", "short"]


class Faults:
    """Counts steps; the one numbered ``at`` fails.

    Parameters
    ----------
    at
        The number of the failing step, from 1; 0 fails none.
    kind
        The name of an errno, or ``short``: of the next bytes written half arrive, and no error tells of it.

    Attributes
    ----------
    steps
        What has been done so far, in order: ``open``, ``write``, ``sync``, ``rename``, ``folder``.
    failed
        Whether the fault has come to pass.
    """

    def __init__(self, at: int = 0, kind: Kind = "EIO") -> None:
        self.at, self.kind = at, kind
        self.steps: list[str] = []
        self.failed = False

    def step(self, what: str) -> None:
        """One more step; raises OSError if it is the one."""
        self.steps.append(what)
        if len(self.steps) == self.at and self.kind != "short":
            self.failed = True
            number = getattr(errno, self.kind)
            raise OSError(number, os.strerror(number))

    def cut(self, data: bytes) -> bytes:
        """What of ``data`` arrives on the disk."""
        short = self.kind == "short" and 0 < self.at <= len(self.steps) and not self.failed
        self.failed = self.failed or short
        return data[: len(data) // 2] if short else data


_now = [Faults()]


def step(what: str) -> None:
    """Called before each step of a write."""
    if len(_now) > 1:
        _now[-1].step(what)


def cut(data: bytes) -> bytes:
    """Called with all bytes that are written."""
    return _now[-1].cut(data) if len(_now) > 1 else data


@contextlib.contextmanager
def failing(at: int = 0, kind: Kind = "EIO") -> Iterator[Faults]:
    """While inside, writes are counted, and the step numbered ``at`` fails."""
    faults = Faults(at, kind)
    _now.append(faults)
    try:
        yield faults
    finally:
        _now.remove(faults)
