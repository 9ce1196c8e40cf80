"""Which side of the boundaries each pixel lies on: smoothness stays on one side."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import barriers

__all__ = ["LOOSE", "one_side", "seen_in_the_other_view", "sides_of"]

LOOSE = -1
"""The side of boundaries that part nothing: loose ends."""


def one_side(shape: tuple[int, int]) -> Array:
    """int32 (H, W) for a view without boundaries."""
    return np.ones(shape, np.int32)


def sides_of(boundaries: Array, brightness: Array) -> Array:
    """int32 (H, W): one number a closed region, boundary pixels with the region they look most like.

    A boundary is where matching knows most; a matcher that left its pixels to neither side would keep that
    from both. A boundary between two pixels of one region is :data:`LOOSE`, a side of its own.

    Parameters
    ----------
    boundaries
        bool (H, W), one to two pixels wide.
    brightness
        float32 (H, W), tells to which region a pixel of the boundary belongs.
    """
    found = barriers.sides(boundaries, brightness)
    found[(found == 0) | _parts_nothing(boundaries, found)] = LOOSE
    return found


def _parts_nothing(boundaries: Array, sides: Array) -> Array:
    """Boundary pixels with only one side within two pixels: loose ends, and lines inside a region."""
    import cv2

    around = np.ones((5, 5), np.uint8)
    numbers = sides.astype(np.float32)
    alike = cv2.dilate(numbers, around) == cv2.erode(numbers, around)
    return np.asarray(boundaries & alike)


def seen_in_the_other_view(sides: Array, field: Array) -> Array:
    """The left view's ``sides`` as the right view sees them through its field (H, W); LOOSE outside."""
    columns = sides.shape[1]
    place = np.rint(np.arange(columns, dtype=np.float32) + field)
    inside = (place >= 0) & (place < columns)
    found = np.take_along_axis(sides, np.where(inside, place, 0).astype(np.int64), axis=1)
    return np.where(inside, found, np.int32(LOOSE))
