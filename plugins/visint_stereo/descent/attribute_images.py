"""Four attribute images: smoothed intensity, gradient magnitude, positive and negative curvature."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["GRADES", "attributes"]

GRADES = 255.0
"""Attributes are in grades of 8 bits: a step from black to white is 255."""


def attributes(image: Array, blur: float) -> Array:
    """float32 (H, W, 4) in 8-bit grades (per pixel, per pixel²), from linear intensity (H, W).

    Curvature is that of the isophotes times the gradient, I_vv, split into its positive and negative part:
    like the gradient's magnitude it does not change when the image turns.

    Parameters
    ----------
    blur
        Standard deviation of the smoothing in pixels: more bears more noise and loses small detail.
    """
    import cv2

    known = np.isfinite(image)
    filled = np.where(known, image, image[known].mean() if known.any() else 0)
    smooth = cv2.GaussianBlur((GRADES * filled).astype(np.float32), (0, 0), blur)
    ix, iy = _derivative(smooth, 1, 0), _derivative(smooth, 0, 1)
    ixx, iyy, ixy = _derivative(smooth, 2, 0), _derivative(smooth, 0, 2), _derivative(smooth, 1, 1)
    squared = ix**2 + iy**2
    curvature = (iyy * ix**2 - 2 * ix * iy * ixy + ixx * iy**2) / (squared + 1)
    return np.stack(
        [smooth, np.sqrt(squared), np.maximum(curvature, 0), np.maximum(-curvature, 0)], axis=-1
    ).astype(np.float32)


def _derivative(image: Array, across: int, down: int) -> Array:
    import cv2

    scale = 1 / 2 ** (3 * 2 - across - down - 2)
    return np.asarray(cv2.Sobel(image, cv2.CV_32F, across, down, ksize=3, scale=scale))
