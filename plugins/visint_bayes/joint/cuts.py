"""Depth edges inside an object: brightness proposes them, the surfaces on both sides decide."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_bayes.joint.domain import Domain

__all__ = ["cut_by", "near_cuts", "patches", "standing"]

STEEP = 0.035
"""Gradient of brightness, parts of the brightest a pixel at 256 pixels, that may be an edge."""
SMALLEST = 0.01
"""Patches below this part of the object are no surfaces of their own."""
STEP = 0.7
"""Steps of disparity below this, px at 256 pixels, are none."""


def patches(calm: Array, mask: Array, noise: float, zoom: float) -> Array:
    """int32 (H, W): parts of ``mask`` between edges of ``calm`` brightness, from 1; 0 outside.

    ``noise`` is the standard deviation of the calm image. One patch where brightness has no edges.
    """
    import cv2

    slope_x, slope_y = (cv2.Sobel(calm, cv2.CV_32F, *way, ksize=3, scale=1 / 8) for way in ((1, 0), (0, 1)))
    slope = np.hypot(slope_x, slope_y)
    bright = float(np.percentile(calm[mask], 95)) if mask.any() else 1.0
    core = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    flat = core & (slope < max(STEEP * bright / zoom, 3 * noise))
    _, labels, stats, _ = cv2.connectedComponentsWithStats(flat.astype(np.uint8), connectivity=4)
    keep = stats[:, cv2.CC_STAT_AREA] >= SMALLEST * mask.sum()
    keep[0] = False
    number = np.where(keep, np.cumsum(keep), 0)
    return _grown(number[labels].astype(np.int32), mask)


def _grown(labels: Array, mask: Array) -> Array:
    """Every pixel of the mask takes the nearest label."""
    from scipy.ndimage import distance_transform_edt

    if not labels.any():
        return mask.astype(np.int32)
    nearest = distance_transform_edt(labels == 0, return_distances=False, return_indices=True)
    return np.where(mask, labels[tuple(nearest)], 0).astype(np.int32)


def cut_by(mask: Array, labels: Array) -> Domain:
    """``mask`` cut wherever labels change."""
    across, down = np.zeros_like(mask), np.zeros_like(mask)
    across[:, :-1] = labels[:, :-1] != labels[:, 1:]
    down[:-1] = labels[:-1] != labels[1:]
    return Domain.of(mask, across, down)


def standing(mask: Array, labels: Array, surface: Array, zoom: float) -> Domain:
    """``mask`` cut only where the surface, found with all cuts, steps between patches."""
    import cv2

    across, down = np.zeros_like(mask), np.zeros_like(mask)
    step = _steps(labels, surface)
    size = 2 * round(3 * zoom) + 1
    wide = cv2.dilate(step, np.ones((size, size), np.uint8))
    near = cv2.boxFilter((step > STEP * zoom).astype(np.float32), -1, (size, size), normalize=False)
    some = cv2.boxFilter((step > 0).astype(np.float32), -1, (size, size), normalize=False)
    agreed = (near > 0.5 * some) & (wide > 0)
    across[:, :-1] = (labels[:, :-1] != labels[:, 1:]) & agreed[:, :-1]
    down[:-1] = (labels[:-1] != labels[1:]) & agreed[:-1]
    return Domain.of(mask, across, down)


def _steps(labels: Array, surface: Array) -> Array:
    """float32 (H, W): the largest step to the right or lower neighbour of another label, else 0."""
    step = np.zeros(surface.shape, np.float32)
    across = np.where(labels[:, :-1] != labels[:, 1:], np.abs(np.diff(surface, axis=1)) + 1e-6, 0)
    down = np.where(labels[:-1] != labels[1:], np.abs(np.diff(surface, axis=0)) + 1e-6, 0)
    both = (labels[:, :-1] > 0) & (labels[:, 1:] > 0)
    step[:, :-1] = np.where(both, across, 0)
    both = (labels[:-1] > 0) & (labels[1:] > 0)
    step[:-1] = np.maximum(step[:-1], np.where(both, down, 0))
    return step


def near_cuts(domain: Domain, reach: float) -> Array:
    """Bool (H, W): pixels within ``reach`` px of a cut inside the domain."""
    import cv2

    mask = domain.inside
    cut = np.zeros_like(mask)
    cut[:, :-1] |= mask[:, :-1] & mask[:, 1:] & ~domain.across[:, :-1]
    cut[:-1] |= mask[:-1] & mask[1:] & ~domain.down[:-1]
    size = 2 * round(reach) + 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    return np.asarray(cv2.dilate(cut.astype(np.uint8), kernel) > 0) & mask
