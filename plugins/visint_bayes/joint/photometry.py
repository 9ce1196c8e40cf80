"""What the second view says: the photometric residual linearised at the current surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["DataTerm", "Views", "data_term", "masked_blur", "views_of"]

GRADES = 255.0
"""Brightness is in grades of 8 bits: full scale is 255."""
LIKENESS = 0.25
"""Variance, squared grades, by which two equal views differ beyond noise."""
PULL = 0.2
"""No patch of data as large as the blur is believed to better than this, px."""


class DataTerm(NamedTuple):
    """Weight (px⁻²) and target disparity (px), float32 (H, W); ``residual`` in grades, NaN where none."""

    weight: Array
    target: Array
    residual: Array


@dataclass(frozen=True, slots=True)
class Views:
    """Both views blurred inside their own masks (grades, float32 (H, W)), masks as float32, and noise.

    ``variance`` is that of the residual of one pixel after the blur; ``area`` the pixels that share it.
    """

    left: Array
    right: Array
    inside_left: Array
    inside_right: Array
    variance: float
    area: float


def masked_blur(image: Array, mask: Array, blur: float) -> Array:
    """``image`` (H, W) blurred inside ``mask`` (float32 0 or 1) only, so that no edge of the mask shows."""
    import cv2

    weight = cv2.GaussianBlur(mask, (0, 0), blur)
    with np.errstate(invalid="ignore", divide="ignore"):
        inner = cv2.GaussianBlur(image * mask, (0, 0), blur) / weight
    return np.where(weight > 1e-3, inner, 0).astype(np.float32)


def views_of(images: tuple[Array, Array], masks: tuple[Array, Array], noise: float, blur: float = 1.2) -> Views:
    """The views as the data term wants them.

    Parameters
    ----------
    images, masks
        Left and right: float32 (H, W) in [0, 1], and bool (H, W).
    noise
        Standard deviation of the noise, in parts of full scale.
    blur
        Standard deviation of the smoothing, px: more bears more noise and sees less detail.
    """
    inside = [mask.astype(np.float32) for mask in masks]
    smooth = [
        masked_blur(GRADES * np.nan_to_num(one), two, blur) for one, two in zip(images, inside, strict=True)
    ]
    area = 4 * np.pi * blur**2
    return Views(smooth[0], smooth[1], inside[0], inside[1], 2 * (GRADES * noise) ** 2 / area + LIKENESS, area)


def data_term(views: Views, field: Array, gap: Array, spread: float = 3.0) -> DataTerm:
    """The residual at ``field`` (H, W) as a pull on each pixel.

    d - r/J with weight J²/(area σ²), less where the residual is beyond ``spread`` standard deviations (robust),
    where the two views' disparities differ (``gap`` px), and nothing where the match leaves the right mask.
    """
    from visint_bayes.joint.matching import _kernels

    value, change, inside, _ = (np.empty_like(field) for _ in range(4))
    _kernels.warp(views.right, field, -1.0, value, change)
    _kernels.warp(views.inside_right, field, -1.0, inside, np.empty_like(field))
    residual = value - views.left
    with np.errstate(invalid="ignore", divide="ignore"):
        strength = change**2 / (views.area * views.variance)
        robust = (1 + residual**2 / (spread**2 * views.variance)) ** -2
        seen = (1 + (gap / 1.5) ** 2) ** -2 * (inside > 0.6) * (views.inside_left > 0)
        weight = np.nan_to_num(strength * robust * seen)
        target = field - np.clip(residual / change, -2, 2)
    weight = np.where(np.isfinite(target), weight / (1 + views.area * PULL**2 * weight), 0)
    residual = np.where(inside > 0.6, residual, np.nan)
    return DataTerm(weight.astype(np.float32), np.nan_to_num(target).astype(np.float32), residual)
