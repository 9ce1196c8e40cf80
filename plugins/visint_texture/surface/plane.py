"""One plane from one texture, without any reference: the uniform-density gradient, then all moments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.tangent import Positions, log_moments, normal_of_slopes, surface_log_moments

__all__ = ["Plane", "best_plane", "density_plane"]

NEAR = 0.05
"""The least nearness, over that at the patch's centre, that a plane may have inside the patch."""


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane's nearness w = 1 + β (U − U₀) + γ (V − V₀), and how well it explains the moments.

    ``slopes`` (β, γ); ``centre`` (U₀, V₀); ``surface`` the log moments (3,) on it; ``residual`` what is left
    of each site's, (N, 3); ``covariance`` (2, 2) of the slopes if sites were independent.
    """

    slopes: Array
    centre: Array
    surface: Array
    residual: Array
    covariance: Array

    def relief(self, at: Positions) -> tuple[Array, Array, Array]:
        """(w, a, b) at image positions (…)."""
        w = 1 + self.slopes[0] * (at.across - self.centre[0]) + self.slopes[1] * (at.down - self.centre[1])
        w = np.maximum(w, NEAR)
        return w, self.slopes[0] / w, self.slopes[1] / w

    @property
    def normal(self) -> Array:
        """Its unit normal (3,)."""
        at = Positions(*(np.asarray(c) for c in self.centre))
        return normal_of_slopes(at, *(np.asarray(s) for s in self.slopes))


def density_plane(moments: Array, at: Positions, weight: Array) -> Array:
    """Slopes (β, γ) of the plane with one density of texture: (det G)^(−1/6) is linear over its image.

    An image area dU dV covers Z³ / (f² d) of a plane d away, and √det G is the square of frequency over
    area. ``moments`` (N, 3), ``weight`` (N,); robust, four rounds.
    """
    centre = _centre(at, weight)
    root = np.exp(-log_moments(moments)[:, 0] / 3)
    root = root / np.median(root)
    design = np.stack([np.ones_like(root), at.across - centre[0], at.down - centre[1]], axis=1)
    trust, fit = weight.copy(), np.array([1.0, 0, 0])
    for _ in range(4):
        held = (design * trust[:, None]).T
        fit = np.linalg.solve(held @ design + 1e-9 * np.eye(3) * weight.sum(), held @ root)
        model = np.maximum(design @ fit, NEAR)
        trust = weight / model**2 / (1 + (np.log(root / model) / 0.15) ** 2)
    return np.asarray(fit[1:] / max(fit[0], NEAR))


def best_plane(moments: Array, at: Positions, weight: Array, rounds: int = 6) -> Plane:
    """The plane on which the moments (N, 3) vary least, by Gauss-Newton from :func:`density_plane`."""
    centre = _centre(at, weight)
    slopes = _inside(density_plane(moments, at, weight), at, centre)
    level = 1e-3
    best = _cost(moments, at, weight, slopes, centre)
    for _ in range(rounds):
        residual, trust, jacobian = _linearised(moments, at, weight, slopes, centre)
        normal = np.einsum("nki,n,nkj->ij", jacobian, trust, jacobian)
        gradient = np.einsum("nki,n,nk->i", jacobian, trust, residual)
        step = np.linalg.solve(normal + level * np.eye(2) * (np.trace(normal) + 1e-9), gradient)
        tried = _inside(slopes - step, at, centre)
        cost = _cost(moments, at, weight, tried, centre)
        if cost < best:
            slopes, best, level = tried, cost, level / 4
        else:
            level *= 10
    return _plane(moments, at, weight, slopes, centre)


def _plane(moments: Array, at: Positions, weight: Array, slopes: Array, centre: Array) -> Plane:
    residual, trust, jacobian = _linearised(moments, at, weight, slopes, centre)
    normal = np.einsum("nki,n,nkj->ij", jacobian, trust, jacobian) + 1e-9 * np.eye(2)
    logs = _logs(moments, at, slopes, centre)
    surface = np.average(logs, axis=0, weights=trust + 1e-12)
    spread = float(np.average(residual**2, axis=0, weights=trust + 1e-12).sum()) / 3
    return Plane(slopes, centre, surface, residual, np.linalg.inv(normal) * spread * weight.max())


def _centre(at: Positions, weight: Array) -> Array:
    total = weight.sum()
    return np.array([(at.across * weight).sum() / total, (at.down * weight).sum() / total])


def _inside(slopes: Array, at: Positions, centre: Array) -> Array:
    """The slopes, less steep if they would put part of the patch beyond the horizon."""
    fall = -(slopes[0] * (at.across - centre[0]) + slopes[1] * (at.down - centre[1])).min()
    return np.asarray(slopes * min(1.0, (1 - NEAR) / max(fall, 1e-9)))


def _logs(moments: Array, at: Positions, slopes: Array, centre: Array) -> Array:
    w = np.maximum(1 + slopes[0] * (at.across - centre[0]) + slopes[1] * (at.down - centre[1]), NEAR)
    return surface_log_moments(moments, at, w, slopes[0] / w, slopes[1] / w)


def _residual(logs: Array, weight: Array) -> tuple[Array, Array]:
    """What differs from the robust mean, and each site's weight."""
    middle = np.median(logs, axis=0)
    for _ in range(2):
        trust = weight / (1 + ((logs - middle) ** 2).sum(axis=1) / 0.3**2)
        middle = (logs * trust[:, None]).sum(axis=0) / trust.sum()
    return logs - middle, trust


def _cost(moments: Array, at: Positions, weight: Array, slopes: Array, centre: Array) -> float:
    residual, _ = _residual(_logs(moments, at, slopes, centre), weight)
    return float((weight * np.log1p((residual**2).sum(axis=1) / 0.3**2)).sum())


def _linearised(
    moments: Array, at: Positions, weight: Array, slopes: Array, centre: Array
) -> tuple[Array, Array, Array]:
    """Residual (N, 3), weights (N,), and the derivative (N, 3, 2) with the mean taken out."""
    here = _logs(moments, at, slopes, centre)
    residual, trust = _residual(here, weight)
    step = 1e-4
    columns = []
    for k in range(2):
        moved = slopes + step * np.eye(2)[k]
        change = (_logs(moments, at, moved, centre) - here) / step
        columns.append(change - (change * trust[:, None]).sum(axis=0) / trust.sum())
    return residual, trust, np.stack(columns, axis=-1)
