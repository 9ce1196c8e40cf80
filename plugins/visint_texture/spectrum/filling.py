"""Whether contrast fills the window, as a texture's does, or stands on a line in it, as an outline's does."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_texture.spectrum.contrast import local_mean

__all__ = ["WHITE", "filling"]

WHITE = 0.375
"""Mean |∇I|² of white noise of variance 1, by the differences used here."""


def filling(image: Array, window: float, noise: Array | None = None) -> Array:
    """float32, of the size of ``noise`` if given, else of the image: 1 where contrast fills the window.

    The energy of the gradient over a sixth of the window, less thrice the ``noise`` (mean |∇I|² of it), is
    compared over the whole window: (mean √e)² / mean e is about 0.3 for one line and nears 1 for many.
    """
    import cv2

    across = cv2.Sobel(image, cv2.CV_32F, 1, 0, ksize=3, scale=1 / 8, borderType=cv2.BORDER_REFLECT)
    down = cv2.Sobel(image, cv2.CV_32F, 0, 1, ksize=3, scale=1 / 8, borderType=cv2.BORDER_REFLECT)
    energy = local_mean(across * across + down * down, window / 6)
    if noise is not None:
        energy = cv2.resize(energy, noise.shape[::-1], interpolation=cv2.INTER_AREA)
        energy = np.maximum(energy - 3 * noise, 0)
        window = window * noise.shape[0] / image.shape[0]
    mean = np.maximum(local_mean(energy, window), np.float32(1e-12))
    return np.asarray(np.minimum(local_mean(np.sqrt(energy), window) ** 2 / mean, 1))
