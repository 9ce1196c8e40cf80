"""How noisy an image is, and what that makes of the attributes."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["noise_of"]


def noise_of(image: Array) -> float:
    """Standard deviation of white noise in ``image`` (H, W), in its own unit.

    Median absolute response of a mask that planes and edges along the axes do not excite (Immerkær 1996,
    doi:10.1006/cviu.1996.0060), so texture counts little. Where a neighbour is unknown, or clipped at 0 or 1,
    nothing is measured; 0 if nothing is left.
    """
    import cv2

    if min(image.shape) < 3:
        return 0.0
    mask = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32)
    response = cv2.filter2D(np.nan_to_num(image), -1, mask)[1:-1, 1:-1]
    usable = (np.isfinite(image) & (image > 0) & (image < 1)).astype(np.uint8)
    whole = cv2.erode(usable, np.ones((3, 3), np.uint8))[1:-1, 1:-1] > 0
    return float(np.median(np.abs(response[whole])) / (0.6745 * 6)) if whole.any() else 0.0
