"""Linear intensity as the eye (and a camera's file) grades it: what census and penalties compare."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["STEPS", "graded"]

STEPS = 4080
"""Grey steps of the graded image: 16 for each step of 8 bits, so that colour's finer grades still count."""


def graded(image: Array) -> Array:
    """uint16 (H, W) in 0..4080: the sRGB curve of linear float32 intensity; unknown pixels are 0.

    Darker parts get more steps, as the noise of a camera wants. Intensities beyond 1 scale the whole image,
    negative ones shift it.
    """
    known = np.nan_to_num(image, nan=0.0, posinf=1.0, neginf=0.0)
    known = known - min(float(known.min()), 0.0)
    known = known / max(float(known.max()), 1.0)
    curve = np.where(known <= 0.0031308, 12.92 * known, 1.055 * known ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(STEPS * curve), dtype=np.uint16)
