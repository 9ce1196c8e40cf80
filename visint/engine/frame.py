"""Where a run is at the moment: level, size and turns. Immutable, so that parallel branches cannot disagree."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Frame"]


class Frame(NamedTuple):
    """Level, (rows, columns) at that level, and the turn of each turn loop around, outermost first."""

    level: int = 0
    size: tuple[int, int] | None = None
    turns: tuple[int, ...] = ()

    @property
    def turn(self) -> int:
        """The turn of the innermost loop, 0 outside."""
        return self.turns[-1] if self.turns else 0
