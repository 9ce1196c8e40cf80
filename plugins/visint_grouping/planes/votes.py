"""What the planes are fitted to: a disparity map, which of it counts how much, and what the right view saw."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Ballot", "views_of"]


class Ballot(NamedTuple):
    """(H, W) each, float32: ``disparity``; ``votes`` (0: a hole); ``right``, the right view's, NaN unknown."""

    disparity: Array
    votes: Array
    right: Array

    @property
    def span(self) -> tuple[float, float]:
        """The least and the largest disparity that a plane may take: those voted for, and 2 px to spare."""
        voted = self.disparity[self.votes > 0]
        return (float(voted.min()) - 2, float(voted.max()) + 2) if voted.size else (0.0, 0.0)


def views_of(left: Array, right: Array) -> tuple[Array, Array]:
    """Census words of both views, uint64 (H, W): which of 62 neighbours are darker. Images of any curve."""
    from visint_grouping.planes import _kernels

    words = []
    for view in (left, right):
        padded = np.pad(np.nan_to_num(view), ((3, 3), (4, 4)), mode="edge")
        words.append(np.empty(view.shape, np.uint64))
        _kernels.census(padded, words[-1])
    return words[0], words[1]
