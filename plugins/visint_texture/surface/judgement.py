"""How far a region's estimate is to be believed: the tests of its own assumptions."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.orientation import slant_and_tilt
from visint_texture.surface.estimate import Estimate
from visint_texture.surface.sites import Sites

__all__ = ["judged", "tested"]

FEWEST = 12
"""A region of fewer sites says nothing."""
LEFT = 0.58
"""Log moments (rms) that a homogeneous texture may leave unexplained: the gate is one half there."""
STRIPED = 1.5
"""Eccentricity from which on a texture counts as stripes: the gate is one half there."""
WINDOWS = 5.0
"""A window covers about 25 sites, so a region's own spread understates its error by about five."""
WAVES = 0.1
"""Radians by which a texture whose waves are a site's spacing long may be off, fewer waves being seen."""


def judged(sites: Sites, estimate: Estimate) -> tuple[Array, Array]:
    """(sigma in radians, reliability in [0, 1]), each (R, C).

    Homogeneity: what the surface leaves of the moments. Two dimensions: a texture of stripes shows its own
    direction, not the surface's, and is not believed. Neighbours: each site alone against the surface that
    all make together. Slant: the steeper, the more a window mixes.
    """
    if np.count_nonzero(sites.weight > 0) < FEWEST:
        return np.ones(sites.shape), np.zeros(sites.shape)
    left = np.sqrt(_around((estimate.residual**2).sum(axis=-1), sites.weight))
    apart = np.sqrt(_around(estimate.disagreement**2, sites.weight))
    sigma = _sigma(estimate, left, _wavelength(sites))
    stripes = np.clip((1.8 - estimate.eccentricity) / 0.6, 0, 1)
    gates = (
        np.exp(-((left / 0.7) ** 2)),
        np.exp(-((apart / np.deg2rad(50)) ** 2)),
        np.exp(-((sigma / np.deg2rad(25)) ** 2)),
        np.broadcast_to(stripes, sites.shape),
    )
    return sigma, np.clip(sites.weight, 0, 1) * np.multiply.reduce(gates)


def tested(sites: Sites, estimate: Estimate) -> dict[str, bool]:
    """Which of its assumptions a region keeps: those that :func:`judged` weighs, where they half count.

    Homogeneity: the surface explains the moments. Sufficient context: the texture is no stripes.
    """
    weight = np.maximum(sites.weight.sum(), 1e-9)
    left = np.sqrt(((estimate.residual**2).sum(axis=-1) * sites.weight).sum() / weight)
    return {"homogeneity": bool(left < LEFT), "sufficient_context": estimate.eccentricity < STRIPED}


def _sigma(estimate: Estimate, left: Array, wave: float) -> Array:
    """Of a plane, its own and what long waves add; of a relief, the residual and more with slant."""
    if estimate.sigma > 0:
        return np.full(left.shape, np.clip(WINDOWS * estimate.sigma + WAVES * wave, 0.01, 1.5))
    slant, _ = slant_and_tilt(estimate.normals)
    # Where a surface turns away a window holds ever more of its turning: worst at limbs (Fig. 3.16).
    return np.clip(0.3 * left + 0.15 * np.minimum(np.tan(slant), 4), 0.03, 1.5)


def _wavelength(sites: Sites) -> float:
    """The texture's middle wavelength over the spacing of the sites."""
    spread = (sites.moments[..., 0] + sites.moments[..., 2])[sites.weight > 0]
    return float(1 / (np.sqrt(np.median(spread)) * max(sites.spacing)))


def _around(field: Array, weight: Array) -> Array:
    """The weighted mean over each site and its eight neighbours."""
    import cv2

    total = cv2.boxFilter(weight, -1, (3, 3), borderType=cv2.BORDER_REFLECT)
    mean = cv2.boxFilter(field * weight, -1, (3, 3), borderType=cv2.BORDER_REFLECT) / np.maximum(total, 1e-9)
    return np.maximum(mean, 0)  # running sums leave tiny negative ones
