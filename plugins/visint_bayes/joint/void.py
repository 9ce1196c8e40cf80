"""Foreground masks where the scene stands before nothing: dark, even, and all around."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["foreground"]

LEAST = 0.05
"""Brightness of a thing, of the brightest, that tells it from the void; darker rims are lost."""
EVEN = 0.02
"""What the smoothed rim of an image may vary by (robust standard deviation) beyond noise to count as void."""
FLAT = 0.055
"""What the well smoothed void may vary by, of the brightest; ten per cent of noise leave 0.033."""
FAR = 4.0
"""Standard deviations of the smoothed void that make a pixel something."""
SPECK = 3e-4
"""Things, and holes in things, below this part of the image are noise."""


def foreground(image: Array) -> Array | None:
    """Bool (H, W): where ``image`` (H, W) shows something; None where no void is to be seen.

    A void is what most of the rim looks like, provided that it is dark and even but for noise. Photographs have
    none, and nothing is claimed of them.
    """
    import cv2

    filled = np.nan_to_num(image)
    bright = float(np.percentile(cv2.GaussianBlur(filled, (0, 0), 1.2), 99))
    smooth = cv2.GaussianBlur(filled, (0, 0), _blur(_rim(image), bright))
    rim = _rim(smooth)
    level = float(np.median(rim))
    spread = 1.4826 * float(np.median(np.abs(rim - level)))
    if spread > EVEN * bright + 0.01 or level > 0.25 * bright:
        return None
    apart = smooth > level + max(FAR * spread, LEAST * bright)
    if np.mean(_rim(apart)) > 0.1 or not 0.005 < apart.mean() < 0.9:
        return None
    mask = _without_specks(apart)
    return mask if _even(filled, ~mask, bright) else None


def _even(image: Array, void: Array, bright: float) -> bool:
    """Whether nothing but noise is seen in the void: photographs with dark corners have texture there."""
    import cv2

    inner = cv2.erode(void.astype(np.uint8), np.ones((9, 9), np.uint8)) > 0
    if not inner.any():
        return False
    low, high = np.percentile(cv2.GaussianBlur(image, (0, 0), 2.0)[inner], [5, 95])
    return bool(high - low < FLAT * bright)


def _blur(rim: Array, bright: float) -> float:
    """As little as the noise of the void allows."""
    noise = 1.5 * float(np.std(np.minimum(rim, np.percentile(rim, 95))))
    return float(np.clip(FAR * noise / (3.54 * LEAST * max(bright, 1e-3)), 0.4, 2.0))


def _rim(image: Array) -> Array:
    return np.concatenate([image[:2].ravel(), image[-2:].ravel(), image[:, :2].ravel(), image[:, -2:].ravel()])


def _without_specks(mask: Array) -> Array:
    least = max(SPECK * mask.size, 4)
    solid = _large(mask, least)
    return np.asarray(~_large(~solid, least))


def _large(mask: Array, least: float) -> Array:
    """The connected parts of at least ``least`` pixels."""
    import cv2

    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    keep = stats[:, cv2.CC_STAT_AREA] >= least
    keep[0] = False
    return np.asarray(keep[labels])
