"""A smooth surface whose texture is one: its nearness over a lattice, held at a reference site."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.tangent import normal_of_slopes, slopes_of_normal, surface_log_moments
from visint_texture.surface.banded import Corners, plate
from visint_texture.surface.sites import Sites

__all__ = ["Anchor", "Relief", "anchored_plane", "fitted", "integrated"]

SPREAD = 0.35
"""Log moments that differ by more than this from the reference's count less and less."""
LEAST = 0.05
OWN = 10.0
"""How many sites the reference's own moments count for."""
HOLD = 1e3
"""How firmly the reference keeps its orientation, against a site's log moments of 1."""


@dataclass(frozen=True, slots=True)
class Anchor:
    """The reference site: its place (row, column) on the lattice, slopes there, and log moments (3,)."""

    place: tuple[int, int]
    slopes: tuple[float, float]
    surface: Array


@dataclass(frozen=True, slots=True)
class Relief:
    """Nearness ``w`` at the cells, 1 at the reference, and its relative slopes; each (R, C).

    ``residual`` (R, C, 3) is what its log moments differ from the texture's, ``surface`` (3,).
    """

    w: Array
    a: Array
    b: Array
    residual: Array
    surface: Array
    cost: float = 0.0

    def misfit(self, sites: Sites) -> float:
        """What of the moments it does not explain, smoothness aside."""
        return _misfit(sites, (self.residual**2).sum(axis=-1))

    def normals(self, sites: Sites) -> Array:
        """Unit normals (R, C, 3)."""
        return normal_of_slopes(sites.at, self.a, self.b)


def integrated(sites: Sites, normals: Array, trust: Array, anchor: Anchor, bend: float) -> Array:
    """Nearness (R+1, C+1) at the corners whose slopes are those of ``normals`` (R, C, 3), by least squares."""
    a, b = slopes_of_normal(sites.at, normals)
    one, none = np.ones(sites.shape), np.zeros(sites.shape)
    system = _anchored(sites, anchor, bend)
    system.add(-a, one, none, none, trust)
    system.add(-b, none, one, none, trust)
    return np.maximum(system.solved(), LEAST)


def anchored_plane(sites: Sites, anchor: Anchor) -> Relief:
    """The plane through the reference: w = 1 + a dU + b dV, with the log moments that all sites have on it."""
    here = (sites.at.across[anchor.place], sites.at.down[anchor.place])
    rise = anchor.slopes[0] * (sites.at.across - here[0]) + anchor.slopes[1] * (sites.at.down - here[1])
    w = np.maximum(1 + rise, LEAST)
    a, b = anchor.slopes[0] / w, anchor.slopes[1] / w
    relief = Relief(w, a, b, _left(sites, w, a, b, anchor), anchor.surface)
    change = _common(sites, relief)
    return replace(relief, residual=relief.residual - change, surface=anchor.surface + change)


def fitted(sites: Sites, start: Array, anchor: Anchor, bend: float, rounds: int) -> Relief:
    """The surface near ``start`` (R+1, C+1) on which the log moments are the reference's (Gauss-Newton).

    ``bend`` is how much slopes may change from cell to cell: less is smoother.
    """
    corners, best = start, np.inf
    for _ in range(rounds):
        anchor, best = _shared(sites, corners, anchor, bend)
        aim = _step(sites, corners, anchor, bend)
        before = best
        for share in (1.0, 0.4):
            tried = np.maximum(corners + share * (aim - corners), LEAST)
            cost = _cost(sites, tried, anchor, bend)
            if cost < best:
                corners, best = tried, cost
                break
        if best > 0.98 * before:
            break
    return replace(_relief(sites, corners, anchor), cost=best)


def _shared(sites: Sites, corners: Array, anchor: Anchor, bend: float) -> tuple[Anchor, float]:
    """The anchor with the log moments that all sites have on this surface, and the cost with them.

    The reference's own moments are as noisy as any; its orientation is what is known.
    """
    shared = replace(anchor, surface=anchor.surface + _common(sites, _relief(sites, corners, anchor)))
    return shared, _cost(sites, corners, shared, bend)


def _common(sites: Sites, relief: Relief) -> Array:
    """What the residuals have in common, (3,), the reference's own counting as several sites."""
    trust = sites.weight / (1 + (relief.residual**2).sum(axis=-1) / SPREAD**2)
    return np.asarray((trust[..., None] * relief.residual).sum(axis=(0, 1)) / (trust.sum() + OWN))


def _relief(sites: Sites, corners: Array, anchor: Anchor) -> Relief:
    w, across, down = Corners(sites.shape, sites.spacing).at_cells(corners)
    w = np.maximum(w, LEAST)
    a, b = across / w, down / w
    return Relief(w, a, b, _left(sites, w, a, b, anchor), anchor.surface)


def _left(sites: Sites, w: Array, a: Array, b: Array, anchor: Anchor) -> Array:
    return surface_log_moments(sites.moments, sites.at, w, a, b) - anchor.surface


def _cost(sites: Sites, corners: Array, anchor: Anchor, bend: float) -> float:
    squares = (_relief(sites, corners, anchor).residual ** 2).sum(axis=-1)
    data = _misfit(sites, squares)
    across = np.diff(corners, 2, axis=1) ** 2
    down = np.diff(corners, 2, axis=0) ** 2
    twist = 2 * np.diff(np.diff(corners, axis=0), axis=1) ** 2
    return float(data + _stiffness(sites, bend) * (across.sum() + down.sum() + twist.sum()))


def _misfit(sites: Sites, squares: Array) -> float:
    return float((sites.weight * np.log1p(squares / SPREAD**2)).sum() * SPREAD**2)


def _stiffness(sites: Sites, bend: float) -> float:
    return 1.0 / (bend * bend * sites.spacing[0] * sites.spacing[1])


def _anchored(sites: Sites, anchor: Anchor, bend: float) -> Corners:
    """The equations of smoothness and of the reference: w = 1 there, and its slopes."""
    system = Corners(sites.shape, sites.spacing)
    system.band += _stiffness(sites, bend) * plate(sites.shape)
    one, none = np.ones(sites.shape), np.zeros(sites.shape)
    hold = np.zeros(sites.shape)
    hold[anchor.place] = 1.0
    system.add(one, none, none, one, 1e4 * hold)
    system.add(np.full(sites.shape, -anchor.slopes[0]), one, none, none, HOLD * hold)
    system.add(np.full(sites.shape, -anchor.slopes[1]), none, one, none, HOLD * hold)
    return system


def _step(sites: Sites, corners: Array, anchor: Anchor, bend: float) -> Array:
    """Where one Gauss-Newton step leads, every residual linear in w, w_U and w_V."""
    relief = _relief(sites, corners, anchor)
    trust = sites.weight / (1 + (relief.residual**2).sum(axis=-1) / SPREAD**2)
    system = _anchored(sites, anchor, bend)
    along_a, along_b = _derivatives(sites, relief, anchor)
    for k in range(3):
        by_a, by_b = along_a[..., k] / relief.w, along_b[..., k] / relief.w
        # δa = (δw_U − a δw) / w; scale enters the first log moment alone, as 2 log w.
        by_w = (2.0 if k == 0 else 0.0) / relief.w - relief.a * by_a - relief.b * by_b
        here = by_w * relief.w + by_a * relief.a * relief.w + by_b * relief.b * relief.w
        system.add(by_w, by_a, by_b, here - relief.residual[..., k], trust)
    return system.solved()


def _derivatives(sites: Sites, relief: Relief, anchor: Anchor) -> tuple[Array, Array]:
    """∂residual/∂a and ∂residual/∂b, (R, C, 3) each, by differences."""
    step = 1e-4
    at, w = sites.at, relief.w
    in_a = surface_log_moments(sites.moments, at, w, relief.a + step, relief.b) - anchor.surface
    in_b = surface_log_moments(sites.moments, at, w, relief.a, relief.b + step) - anchor.surface
    return (in_a - relief.residual) / step, (in_b - relief.residual) / step
