"""The shading term: what brightness says about slopes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint_bayes.joint.slant import lighting

__all__ = ["Brightness", "SlopeTerm", "slope_term"]

FARTHEST = 0.3
"""Brightness asks for no larger change of n·l at once."""
ROBUST = 0.15
"""A difference of n·l that counts a quarter of its weight."""


@dataclass(frozen=True, slots=True)
class Brightness:
    """n·l as brightness says, float32 (H, W), NaN where it says nothing, and its sigma; the light."""

    incidence: Array
    sigma: Array
    light: Light


class SlopeTerm(NamedTuple):
    """``rows`` (H, W, 3): coefficients of d_u and d_v, and weight; ``wanted`` (H, W): the change of n·l."""

    rows: Array
    wanted: Array


def slope_term(
    known: Brightness | None, amplitude: float, surface: Array, slopes: Array, camera: Camera
) -> SlopeTerm:
    """n·l linearised by the slopes of the current surface: it constrains the slope along the light only.

    ``amplitude`` scales its weight; 0 takes shading out.
    """
    if known is None or amplitude == 0:
        return SlopeTerm(np.zeros((*surface.shape, 3), np.float32), np.zeros(surface.shape, np.float32))
    lit = lighting(surface, slopes, camera, known.light)
    wanted = np.clip(known.incidence - lit.cosine, -FARTHEST, FARTHEST)
    with np.errstate(invalid="ignore"):
        robust = (1 + (wanted / ROBUST) ** 2) ** -2
        weight = np.nan_to_num(amplitude * robust / known.sigma**2)
    rows = np.stack([lit.by_u, lit.by_v, weight], axis=-1).astype(np.float32)
    return SlopeTerm(rows, np.nan_to_num(wanted).astype(np.float32))
