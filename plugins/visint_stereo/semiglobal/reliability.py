"""How likely a disparity is right: a logistic model of nine signs, and the precision of those that are."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_stereo.semiglobal.winner import Winners

__all__ = ["SIGNS", "contrast", "reliability", "signs"]

SIGNS = ("margin", "least", "crowd", "agree 7", "agree 7²", "agree 21", "texture", "apart", "border")
"""The signs, in the order of the weights."""

WEIGHTS = np.array([-0.97, -0.88, -0.08, 6.54, -5.53, -3.15, 0.75, 0.40, 0.70], dtype=np.float32)
BIAS = np.float32(-0.45)


def _mean(values: Array, size: int) -> Array:
    import cv2

    return np.asarray(cv2.blur(values.astype(np.float32), (size, size), borderType=cv2.BORDER_REFLECT_101))


def contrast(grades: Array) -> Array:
    """float32 (H, W): mean squared brightness step along the row in 9×9, in squared 8-bit grades."""
    brightness = grades.astype(np.float32) / 16
    return _mean(np.gradient(brightness, axis=1) ** 2 if grades.shape[1] > 1 else brightness * 0, 9)


def signs(grades: Array, won: Winners, trusted: Array, disparity: Array) -> Array:
    """float32 (9, H, W): what tells right disparities from wrong ones; see :data:`SIGNS`.

    The winner's lead over the second best, its cost, how many levels come near it, the share of pixels
    around it on which both views agree (7×7 and 21×21), texture, how far it lies from the mean of what is
    agreed on around it, and how far its match lies inside the other image.
    """
    least, second = won.least.astype(np.float32), won.second.astype(np.float32)
    agree = trusted.astype(np.float32)
    near = _mean(agree, 7)
    share = _mean(agree, 15)
    usual = _mean(np.where(trusted, disparity, 0), 15) / np.maximum(share, 1e-6)
    apart = np.where(share > 0, np.minimum(np.abs(disparity - usual), 8), 8)
    inside = np.arange(disparity.shape[1], dtype=np.float32) - disparity
    return np.stack(
        [
            np.log1p(10 * (second - least) / (least + 40)),
            least / 500,
            np.log1p(won.crowd.astype(np.float32)),
            near,
            near**2,
            _mean(agree, 21),
            np.log1p(contrast(grades)) / 5,
            apart,
            np.clip(inside, -5, 10) / 10,
        ]
    ).astype(np.float32)


def reliability(grades: Array, won: Winners, trusted: Array, disparity: Array) -> Array:
    """float32 (H, W) in [0, 1): the chance that ``disparity`` is right to 2 px; NaN counts as 0."""
    odds = np.tensordot(WEIGHTS, signs(grades, won, trusted, np.nan_to_num(disparity)), axes=1) + BIAS
    return np.asarray(np.where(np.isfinite(disparity), 1 / (1 + np.exp(odds)), 0), dtype=np.float32)
