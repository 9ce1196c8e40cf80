"""Contrast: brightness over what it is nearby, so that shading and illumination hardly count."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["FLOOR", "contrast", "local_mean"]

FLOOR = 0.05
"""Brightness that is dark: what is much darker counts little, so that noise there makes no texture."""


def local_mean(field: Array, spread: float) -> Array:
    """float32 (H, W): the Gaussian mean over ``spread`` px, mirrored at the image's sides.

    Wide means are taken on a coarser lattice, where they cost little.
    """
    import cv2

    step = max(1, int(spread / 4))
    rows, columns = field.shape
    small = (max(1, round(columns / step)), max(1, round(rows / step)))
    coarse = cv2.resize(field, small, interpolation=cv2.INTER_AREA) if step > 1 else field
    width = max(spread / step, 1e-3)
    coarse = cv2.GaussianBlur(coarse, (0, 0), width, borderType=cv2.BORDER_REFLECT)
    even: Array = cv2.resize(coarse, (columns, rows), interpolation=cv2.INTER_LINEAR) if step > 1 else coarse
    return even


def contrast(image: Array, spread: float) -> Array:
    """float32 (H, W): (I − mean) / (mean + floor) with the mean over ``spread`` px; unknown pixels give 0.

    Dividing takes out what multiplies albedo slowly: shading. Limited to ±1, so that a lone highlight or
    the outline against a dark ground does not drown the texture beside it.
    """
    known = np.isfinite(image)
    whole = bool(known.all())
    filled = image if whole else np.where(known, image, np.float32(0))
    mean = local_mean(filled, spread)
    if not whole:
        share = local_mean(known.astype(np.float32), spread)
        mean = mean / np.maximum(share, np.float32(1e-3))
    relative = (filled - mean) / (np.maximum(mean, 0) + np.float32(FLOOR))
    limited = np.clip(relative, -1, 1)
    return (limited if whole else np.where(known, limited, 0)).astype(np.float32, copy=False)
