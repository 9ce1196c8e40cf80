"""How likely a disparity is right: a logistic model of nine signs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from visint.arrays import Array
from visint_stereo.semiglobal.winner import Winners

__all__ = ["SIGNS", "TrainedOn", "contrast", "reliability", "signs"]

SIGNS = ("margin", "least", "crowd", "agree 7", "agree 7²", "agree 21", "texture", "apart", "border")
"""The signs, in the order of the weights."""

TrainedOn = Literal["all", "A", "B"]
WEIGHTS: Mapping[TrainedOn, tuple[float, ...]] = {
    "all": (0.776, 0.647, 0.088, -3.539, 2.388, 5.212, -0.174, -0.145, -1.910),
    "A": (0.752, 0.405, 0.124, -4.029, 3.022, 5.386, -0.290, -0.152, -2.076),
    "B": (0.802, 0.723, 0.070, -3.166, 1.872, 5.012, -0.085, -0.140, -1.734),
}
BIAS: Mapping[TrainedOn, float] = {"all": -0.703, "A": -0.565, "B": -0.781}
"""Of a right disparity, fitted by logistic regression on public pairs (all, or one of two halves, so that the
other can be reported on) and, at a third of their weight, on rendered scenes with and without noise and on
pairs of unrelated images, where everything is wrong. Signs overlap: a single weight means little."""


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


def reliability(of: Array, trained_on: TrainedOn = "all") -> Array:
    """float32 (H, W) in (0, 1): the chance that a disparity with these signs ``of`` it is right to 2 px."""
    odds = np.tensordot(np.asarray(WEIGHTS[trained_on], np.float32), of, axes=1) + BIAS[trained_on]
    return np.asarray(1 / (1 + np.exp(-odds)), dtype=np.float32)
