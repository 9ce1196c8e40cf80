"""Whether shading may speak at all: brightness held against the map's surface, region by region."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_shading.brightness.evening import evened_inside

__all__ = ["Agreement", "agreement_of", "trust_of"]

FLAT = 0.08
LEAST_COSINE = 0.3
"""Darker than this, limbs and attached shadows rule; they take no part in the test."""


class Agreement(NamedTuple):
    """How brightness and surface agree, float64 (N + 1,) by label.

    ``windows``: area in windows of the mean, about the number of independent values. ``correlation`` of
    brightness and cosine of incidence. ``contrast`` and ``bend``: standard deviations of brightness, in parts
    of its mean, and of the cosine. ``scatter``: standard deviation of their quotient in parts of its mean.
    ``grain``: contrast finer than the window, noise apart. ``ratio``: mean quotient. ``pooled``: correlation
    over all regions together; ``pooled_ratio`` its quotient.
    """

    windows: Array
    correlation: Array
    contrast: Array
    bend: Array
    scatter: Array
    grain: Array
    ratio: Array
    pooled: float
    pooled_ratio: float


def agreement_of(
    even: Array, spread: float, labels: Array, cosine: Array, ambient: float, window: float
) -> Agreement:
    """Brightness ``even`` against ``cosine`` (H, W), which is NaN unknown and was evened over ``window`` px."""
    from visint_shading import _kernels

    wide = evened_inside(even, labels, window)
    sums = np.zeros((int(labels.max(initial=0)) + 1, 9))
    _kernels.agreement_sums(
        even, wide, cosine, cosine + np.float32(ambient), labels, np.float32(LEAST_COSINE), sums
    )
    return _from_sums(sums, spread, 4 * np.pi * window**2)


def _from_sums(sums: Array, spread: float, window_area: float) -> Agreement:
    count = np.maximum(sums[:, 0], 1)
    e, ee, c, cc, ec, r, rr, dd = (sums[:, k] / count for k in range(1, 9))
    of_e, of_c = np.maximum(ee - e * e, 0), np.maximum(cc - c * c, 0)
    whole = sums.sum(axis=0)
    return Agreement(
        windows=sums[:, 0] / window_area,
        correlation=_correlation(ec - e * c, of_e, of_c),
        contrast=np.sqrt(of_e) / np.maximum(e, 1e-6),
        bend=np.sqrt(of_c),
        scatter=np.sqrt(np.maximum(rr - r * r, 0)) / np.maximum(r, 1e-6),
        grain=np.sqrt(np.maximum(dd - spread**2, 0)) / np.maximum(e, 1e-6),
        ratio=r,
        pooled=_pooled(whole),
        pooled_ratio=float(whole[6] / max(whole[0], 1)),
    )


def _pooled(whole: Array) -> float:
    e, ee, c, cc, ec = whole[1:6] / max(whole[0], 1)
    return float(_correlation(ec - e * c, np.maximum(ee - e * e, 0), np.maximum(cc - c * c, 0)))


def _correlation(covariance: Array, of_e: Array, of_c: Array) -> Array:
    return np.asarray(covariance / np.sqrt(np.maximum(of_e * of_c, 1e-12)))


def trust_of(found: Agreement, albedo: Array) -> Array:
    """float64 (N + 1,) in [0, 1]: may shading speak in a region?

    Only where brightness follows the map's surface (a region's own correlation, or, if brightness or surface
    hardly change within it, that of all regions if this one has the albedo of the rest), where their quotient
    is constant and near the region's ``albedo`` (highlights lift maxima above it), and where nothing finer than
    the surface's bends is seen. Thresholds lie between lab scenes with and without texture, of seeds 100 to 305
    and the 1992 matcher's depth; see the page on shading.
    """
    own = _ramp(found.correlation, 0.6, 0.85) * (found.bend > 0.015) * (found.contrast > 0.015)
    shared = _ramp(np.asarray(found.pooled), 0.5, 0.8) * _alike(found) * (found.contrast < FLAT)
    even = (1 - _ramp(found.scatter, 0.18, 0.32)) * (1 - _ramp(found.grain, 0.11, 0.2))
    near = 1 - _ramp(np.abs(np.log(np.maximum(albedo, 1e-6) / np.maximum(found.ratio, 1e-6))), 0.15, 0.35)
    return np.asarray(np.maximum(own, shared) * even * near * _ramp(found.windows, 1.0, 4.0))


def _alike(found: Agreement) -> Array:
    return np.asarray(np.abs(found.ratio / max(found.pooled_ratio, 1e-6) - 1) < 0.2)


def _ramp(value: Array, low: float, high: float) -> Array:
    return np.clip((value - low) / (high - low), 0, 1)
