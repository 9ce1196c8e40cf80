"""A loop's caption in its frame: how much room it takes, and where no edge runs through it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from visint.graph.drawing.lettering import fitted, widest, width
from visint.graph.drawing.model import Group

__all__ = ["HEAD", "LINE", "LONGEST", "caption_size", "caption_spot"]

HEAD, LINE = 12.0, 10.5
"""Sizes of the letters: the loop's name, and the lines below it."""
LONGEST = 60
MARGIN = 12.0


def caption_size(group: Group) -> tuple[float, float]:
    """Width and height of the caption of ``group``, margins included."""
    lines = [fitted(line, LONGEST) for line in group.caption]
    w = max(width("↻ " + fitted(group.name), HEAD, bold=True), widest(lines, LINE))
    return w + 2 * MARGIN, 24.0 + 14.0 * len(lines)


def caption_spot(group: Group, doors: Sequence[float], left: float, right: float) -> tuple[float, float, float]:
    """The left and right side of the frame, and where its caption begins: the first room between ``doors``.

    Where there is none, the frame grows to the left.
    """
    w = caption_size(group)[0]
    stops = [left, *doors, right]
    for one, other in pairwise(stops):
        if other - one >= w:
            return left, right, one + MARGIN
    if not doors:
        return left, left + w, left + MARGIN
    return doors[0] - w, right, doors[0] - w + MARGIN
