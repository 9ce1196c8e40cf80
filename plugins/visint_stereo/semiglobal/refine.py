"""Between the levels: the disparity that brightness itself prefers, and how precisely."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_stereo.semiglobal.volume import Levels

__all__ = ["refined"]

TURNS = 3
WINDOW = 5
"""Pixels that share a correction: more is steadier and rounds corners off."""
SURROUND = 25
"""Window of the mean brightness difference that is taken out first: views differ in exposure."""
STEP = 0.3
"""Standard deviation of the fit between levels, px: what brightness has to beat."""
AT_ENDS = 1.2
"""The same at the ends of the search range, where nothing was fitted."""
REACH = 1.0
"""A correction beyond this many px is a mismatch, not a correction."""


def refined(
    disparity: Array, trusted: Array, views: tuple[Array, Array], levels: Levels
) -> tuple[Array, Array]:
    """(disparity, sigma), float32 (H, W): ``disparity`` corrected by the brightness of both views.

    Gauss-Newton steps, shared by the trusted pixels of a small window and held back by the fit between
    levels: d = (mean J² (d - r/J) + κ d₀) / (mean J² + κ) with κ = var(r) / STEP². Sigma is the deviation that
    this weighting implies, with the residual measured in place. Neighbouring residuals err alike, so the
    window counts as one measurement, not as 25.

    Parameters
    ----------
    disparity
        Start, px; trusted pixels only are corrected.
    views
        Graded brightness of the left and right view, float32 (H, W).
    levels
        The disparities searched: at either end there was no fit between levels to hold on to.
    """
    from visint_stereo.semiglobal import _kernels

    left, right = views
    firm = np.where(levels.searched(disparity), STEP, AT_ENDS).astype(np.float32) ** -2
    weight = trusted.astype(np.float32)
    share = np.maximum(_mean(weight, WINDOW), 1e-3)
    around = np.maximum(_mean(weight, SURROUND), 1e-3)
    steps = _slope(left)
    values, slopes = np.empty_like(left), np.empty_like(left)
    current, sigma = disparity, np.full_like(disparity, STEP)
    for _ in range(TURNS):
        _kernels.warp(right, current, values, slopes)
        residual = left - values
        residual = residual - _mean(weight * residual, SURROUND) / around
        slope = (steps + slopes) / 2
        precision = _mean(weight * slope**2, WINDOW)
        noise = _mean(weight * residual**2, WINDOW) / share + np.float32(0.01)
        hold = noise * firm
        pull = _mean(weight * slope * (slope * current - residual), WINDOW)
        proposed = (pull + hold * disparity) / (precision + hold)
        near = trusted & (np.abs(proposed - disparity) <= REACH)
        current = np.where(near, proposed, disparity)
        sigma = np.where(near, np.sqrt(noise / (precision + hold)), STEP)
    return current, sigma.astype(np.float32)


def _mean(values: Array, size: int) -> Array:
    import cv2

    return np.asarray(cv2.blur(values, (size, size), borderType=cv2.BORDER_REFLECT_101))


def _slope(image: Array) -> Array:
    """Slope along the row, float32 (H, W), by five points."""
    import cv2

    taps = np.array([[1, -8, 0, 8, -1]], dtype=np.float32) / 12
    return np.asarray(cv2.filter2D(image, -1, taps, borderType=cv2.BORDER_REPLICATE))
