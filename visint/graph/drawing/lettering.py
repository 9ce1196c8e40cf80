"""Words in a drawing: made safe to show, measured (by the widths of Arial, no font is asked) and cut to fit."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["clean", "fitted", "widest", "width"]

_NARROW = frozenset("iljtfrI.,:;|!'()[]/ -·")
_WIDE = frozenset("mwMWOQGCDHNU@%—…↻")
_LONGEST = 44


def clean(text: object) -> str:
    """``text`` on one line; what cannot be printed, or would turn the writing round, becomes ``\ufffd``."""
    line = " ".join(str(text).split())
    return "".join(char if char.isprintable() else "\ufffd" for char in line)


def fitted(text: str, most: int = _LONGEST) -> str:
    """``text`` cleaned, and cut after ``most`` characters; the whole of it belongs into the tooltip."""
    line = clean(text)
    return line if len(line) <= most else line[: most - 1] + "…"


def _share(char: str) -> float:
    if char in _NARROW:
        return 0.34
    if char in _WIDE:
        return 0.84
    return 0.57 if char.isascii() else 1.0


def width(text: str, size: float, bold: bool = False) -> float:
    """The width of ``text`` at ``size``, a little generous since the reader's font is not known."""
    return sum(map(_share, text)) * size * (1.12 if bold else 1.05)


def widest(texts: Iterable[str], size: float, bold: bool = False) -> float:
    """The width of the widest of ``texts``, 0 where there are none."""
    return max((width(text, size, bold) for text in texts), default=0.0)
