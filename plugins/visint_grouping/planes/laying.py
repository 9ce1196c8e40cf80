"""A plane for each region laid out as a disparity map, with what the right view says to it."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_grouping.planes.choice import Chosen
from visint_grouping.planes.votes import Ballot

__all__ = ["laid_out"]


def laid_out(labels: Array, chosen: Chosen, ballot: Ballot) -> tuple[Array, Array]:
    """(disparity, its sight).

    Sight, uint8: 0 where the plane would hide something that the right view sees, or lies out of range;
    1 outside the right image, 2 hidden from it, 3 seen.
    """
    from visint_grouping.planes import _kernels

    value, sight = np.empty(labels.shape, np.float32), np.empty(labels.shape, np.uint8)
    _kernels.laid(labels, chosen.planes, ballot.right, ballot.span, value, sight)
    return value, sight
