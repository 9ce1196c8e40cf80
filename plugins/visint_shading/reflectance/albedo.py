"""Albedo a region: from its brightest pixels where they face the light, else from all of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Albedo", "albedo_by_region", "given_by_region", "percentile_by_region", "percentiles_by_region"]

FACING = 0.93
"""Cosine of incidence (21°) from which a region's brightest twentieth counts as facing the light."""
FACED = 0.985
"""What that cosine is on a sphere: so much of it belongs to facing the light."""
STEPS = 512


class Albedo(NamedTuple):
    """By label, float64 (N + 1,): the albedo (0 unknown), its relative error, and whether a maximum gave it."""

    value: Array
    error: Array
    by_maximum: Array


def percentile_by_region(values: Array, labels: Array, share: float) -> Array:
    """float64 (N + 1,): the value that ``share`` of a region's pixels stay below; 0 for what is not there.

    ``values`` are float32 (H, W) in [0, 1]; exact to 1/1024.
    """
    return percentiles_by_region(values, labels, share)[0]


def percentiles_by_region(values: Array, labels: Array, *shares: float) -> list[Array]:
    """The same for each of ``shares``."""
    count = int(labels.max(initial=0)) + 1
    inside = labels > 0
    step = np.clip(values[inside] * STEPS, 0, STEPS - 1).astype(np.int64)
    table = np.bincount(labels[inside] * np.int64(STEPS) + step, minlength=count * STEPS).reshape(count, STEPS)
    below = np.cumsum(table, axis=1)
    total = below[:, -1]
    found = ((below < share * total[:, None]).sum(axis=1) for share in shares)
    return [np.where(total > 0, (steps + 0.5) / STEPS, 0.0) for steps in found]


def albedo_by_region(even: Array, labels: Array, cosine: Array | None, spread: float, ambient: float) -> Albedo:
    """Albedo of each region from brightness ``even`` (H, W) in [0, 1].

    The robust maximum (99th percentile, erratum to section 4.2 C(iii)) where the map says that the brightest
    pixels face the light; else brightness regressed on ``cosine`` + ``ambient``. Without ``cosine`` the
    brightest pixels are taken to face the light. ``spread`` is the noise of ``even``.
    """
    count = int(labels.max(initial=0))
    bright, brightest = percentiles_by_region(even, labels, 0.95, 0.99)
    maximum = np.maximum(brightest - 1.5 * spread, 0) / (1 + ambient)
    if cosine is None:
        return Albedo(maximum, np.full(count + 1, 0.1), maximum > 0)
    regressed = _regressed(even, labels, cosine, ambient, count)
    leans = _cosine_of_brightest(even, labels, cosine, bright)
    faces = (leans > FACING) & (maximum > 0)
    value = np.where(faces, maximum / np.clip(leans / FACED, 0.9, 1), regressed)
    return Albedo(value, np.where(faces, 0.02, 0.05), faces)


def _regressed(even: Array, labels: Array, cosine: Array, ambient: float, count: int) -> Array:
    from visint_shading import _kernels

    lit = np.isfinite(cosine) & (cosine > 0.35) & (labels > 0)
    found = np.zeros(count + 1)
    shade = (np.where(lit, cosine, 0) + np.float32(ambient)).astype(np.float32)
    _kernels.fitted(even, shade, lit.astype(np.float32), labels, np.float32(0.1), 5, found)
    return found


def _cosine_of_brightest(even: Array, labels: Array, cosine: Array, bright: Array) -> Array:
    """float64 (N + 1,): the map's mean cosine over what is as ``bright`` in each region; 0 unknown."""
    top = (labels > 0) & np.isfinite(cosine)
    top &= even >= bright[np.where(top, labels, 0)]
    sums = np.bincount(labels[top], cosine[top], minlength=bright.size)
    members = np.bincount(labels[top], minlength=bright.size)
    return np.asarray(sums / np.maximum(members, 1))


def given_by_region(albedo: Array, labels: Array) -> Albedo:
    """The mean of a given albedo (H, W) over each region; NaN and 0 are unknown."""
    known = (labels > 0) & (albedo > 0)
    count = int(labels.max(initial=0)) + 1
    members = np.bincount(labels[known], minlength=count)
    value = np.bincount(labels[known], albedo[known], minlength=count) / np.maximum(members, 1)
    return Albedo(value, np.full(count, 0.02), value > 0)
