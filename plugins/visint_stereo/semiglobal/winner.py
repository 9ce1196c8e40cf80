"""The cheapest disparity of each pixel, and what its costs say about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array
from visint_stereo.semiglobal.volume import Volume

__all__ = ["Winners", "winners"]


@dataclass(frozen=True, slots=True)
class Winners:
    """Winners of both views.

    ``disparity`` float32 (H, W), between levels, px; ``right`` int32 (H, W), the right view's disparity
    (-32768 where none); ``least``, ``second`` and ``crowd`` uint16 (H, W): the winner's cost, the cheapest
    cost further than a level away, and how many levels come near the winner.
    """

    disparity: Array
    right: Array
    least: Array
    second: Array
    crowd: Array


def winners(volume: Volume) -> Winners:
    """The winners of a volume; the right view's are read along the diagonals of the left's volume."""
    from visint_stereo.semiglobal import _kernels

    shape = volume.total.shape
    total = volume.total.reshape(-1)
    first, base = volume.levels.first, volume.levels.lowest(shape[:2])
    best, right = (np.empty(shape[:2], dtype=np.int32) for _ in range(2))
    least, second, crowd = (np.empty(shape[:2], dtype=np.uint16) for _ in range(3))
    disparity = np.empty(shape[:2], dtype=np.float32)
    _kernels.winners(total, shape, best, least, second, crowd)
    _kernels.right_winners(total, shape, first, base, right)
    _kernels.between_levels(total, shape, best, first, base, disparity)
    return Winners(_median(disparity), right, least, second, crowd)


def _median(disparity: Array) -> Array:
    import cv2

    return np.asarray(cv2.medianBlur(disparity, 5))
