"""The regions in which one albedo is supposed."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["patches"]


def patches(usable: Array, regions: Array | None, boundaries: Array | None) -> Array:
    """int32 (H, W): labels from 1, 0 where nothing is to be said.

    ``usable`` is bool (H, W). Regions go before boundaries, whose 4-connected complement is taken; without
    either all that is usable is one region.
    """
    if regions is not None:
        return np.where(usable, np.maximum(regions, 0), 0).astype(np.int32)
    if boundaries is not None:
        import cv2

        _, labels = cv2.connectedComponents((usable & ~boundaries).astype(np.uint8), connectivity=4)
        return np.asarray(labels, np.int32)
    return usable.astype(np.int32)
