"""Smoothing a pair whose noise drowns its texture: census bits of noise match nothing."""

from __future__ import annotations

import math

import numpy as np

from visint.arrays import Array
from visint_stereo.noise import noise_of

__all__ = ["calmed"]

BLURS = (1.0, 2.0, 4.0)
"""Standard deviations tried, px."""
QUIET = 2.5
"""Gradient energy of the image over that of its noise from which on nothing is smoothed. White noise has 1,
photographs 3 to 70, shaded surfaces under 2 % noise 1 to 1.5."""
CLEAR = 200.0
"""The same after smoothing: the least blur that reaches it is taken."""


def calmed(left: Array, right: Array) -> tuple[Array, Array, float]:
    """Both views (H, W), smoothed alike if they need it, and the standard deviation used, px; 0 for none.

    The better part of what is lost to noise comes back: on shaded surfaces under 2 % noise six times as many
    disparities are right, on textured ones under 10 % a quarter more.
    """
    import cv2

    blur = max(_blur_for(left), _blur_for(right))
    if blur == 0:
        return left, right, 0.0
    smooth = [cv2.GaussianBlur(np.nan_to_num(view), (0, 0), blur) for view in (left, right)]
    return smooth[0], smooth[1], blur


def _blur_for(view: Array) -> float:
    noise = noise_of(view)
    if noise == 0 or _clarity(view, noise, 0.0) >= QUIET:
        return 0.0
    return next((blur for blur in BLURS if _clarity(view, noise, blur) >= CLEAR), BLURS[-1])


def _clarity(view: Array, noise: float, blur: float) -> float:
    """Median gradient energy along rows, 9×9, over what smoothed white noise alone would have.

    A central difference of white noise has variance σ²/2, after a Gaussian of width s about σ²/(8 π s⁴).
    Where the image is clipped or unknown nothing is measured.
    """
    import cv2

    usable = (np.isfinite(view) & (view > 0) & (view < 1)).astype(np.uint8)
    whole = cv2.erode(usable, np.ones((9, 9), np.uint8)) > 0
    if not whole.any() or view.shape[1] < 2:
        return math.inf
    smooth = cv2.GaussianBlur(view, (0, 0), blur) if blur else view
    energy = cv2.blur(np.gradient(smooth, axis=1) ** 2, (9, 9))
    alone = noise**2 * (1 / (8 * math.pi * blur**4) if blur else 0.5)
    return float(np.median(energy[whole])) / alone
