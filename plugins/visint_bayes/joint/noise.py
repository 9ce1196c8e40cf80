"""How much of an image is noise."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["noise_inside"]


def noise_inside(image: Array, mask: Array) -> float:
    """Robust standard deviation of the noise of ``image`` (H, W) inside ``mask``, in the image's unit.

    The median response of a mask that planes do not excite (Immerkær 1996, doi:10.1006/cviu.1996.0060), where
    nothing is clipped.
    """
    import cv2

    kernel = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float32)
    response = cv2.filter2D(np.nan_to_num(image), -1, kernel)
    usable = mask & np.isfinite(image) & (image > 0) & (image < 1)
    whole = cv2.erode(usable.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return float(np.median(np.abs(response[whole])) / (0.6745 * 6)) if whole.any() else 0.0
