"""What a matched field is worth: precision, agreement of the two views, and what that says together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array

__all__ = ["Judgement", "judged"]

NEAR = 9
"""Pixels over which texture is looked for around a pixel: the match rests on them through smoothness."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """float32 (H, W) each.

    ``support`` mean Σ w J² around the pixel, ``strength`` at the pixel itself, ``error`` mean Σ w R² around it,
    ``gap`` |d_l(x) - d_r(x - d_l)| in px; NaN where the match lies outside the other image.
    """

    support: Array
    strength: Array
    error: Array
    gap: Array


def judged(left: Array, right: Array, weights: Array, fields: tuple[Array, Array]) -> Judgement:
    """The judgement of the left one of two ``fields`` (left, right) on attributes float32 (H, W, C)."""
    from visint_stereo.descent import _kernels

    field, back = fields
    slope, strength, error, there = (np.empty_like(field) for _ in range(4))
    _kernels.compare(left, right, weights, np.float32(-1), field, slope, strength, error)
    _kernels.follow(back, field, np.float32(-1), there)
    outside = np.isnan(strength)
    known = np.where(outside, np.float32(0), strength)
    wrong = np.where(outside, np.float32(0), error)
    return Judgement(_around(known), known, _around(wrong), np.abs(field - there))


def _around(values: Array) -> Array:
    import cv2

    means = cv2.blur(values, (NEAR, NEAR), borderType=cv2.BORDER_REFLECT_101)
    return np.maximum(means, np.float32(0))  # running sums may round below 0
