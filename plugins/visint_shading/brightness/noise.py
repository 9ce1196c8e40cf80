"""How noisy an image is."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["noise_of"]

_MASK = np.outer((1, -2, 1), (1, -2, 1)).astype(np.float32)


def noise_of(image: Array) -> float:
    """Standard deviation of white noise in ``image`` float32 (H, W), in its own unit.

    The median response to a mask blind to planes and to edges along the axes (Immerkær 1996,
    doi:10.1006/cviu.1996.0060). What is clipped at 0 or 1, or unknown, tells nothing; 0 if nothing is left.
    """
    import cv2

    if min(image.shape) < 3:
        return 0.0
    response = cv2.filter2D(np.nan_to_num(image), -1, _MASK)[1:-1, 1:-1]
    inside = (np.isfinite(image) & (image > 0) & (image < 1)).astype(np.uint8)
    whole = cv2.erode(inside, np.ones((3, 3), np.uint8))[1:-1, 1:-1] > 0
    return float(np.median(np.abs(response[whole])) / (0.6745 * 6)) if whole.any() else 0.0
