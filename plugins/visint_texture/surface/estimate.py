"""Orientation of one textured region: held at a reference, or as one plane without."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from visint.arrays import Array
from visint.fields import known as known_at
from visint_texture.geometry.canonical import Canonical
from visint_texture.geometry.orientation import nearest
from visint_texture.geometry.tangent import Positions, normal_of_slopes
from visint_texture.geometry.viewing import normal_candidates
from visint_texture.surface.plane import best_plane
from visint_texture.surface.reference import anchor_at
from visint_texture.surface.relief import Anchor, Relief, anchored_plane, fitted, integrated
from visint_texture.surface.sites import Sites

__all__ = ["Estimate", "Stiffness", "as_plane", "from_reference"]


@dataclass(frozen=True, slots=True)
class Stiffness:
    """``bend``: how much relative slopes may change over a cell; ``rounds`` of Gauss-Newton."""

    bend: float = 2.0
    rounds: int = 4


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a region's texture says at its sites, each (R, C, …).

    ``normals``; ``residual`` log moments (R, C, 3) left; ``eccentricity`` ½ log(M/m) of the texture itself;
    ``disagreement``, radians, between each site alone and the surface; ``clarity`` of the tilt in [0, 1];
    ``sigma``, radians, of the whole region's orientation (0 where only sites have one).
    """

    normals: Array
    residual: Array
    eccentricity: float
    disagreement: Array
    clarity: Array
    sigma: float


def from_reference(
    sites: Sites, place: tuple[int, int], known: Array, expected: Array, stiffness: Stiffness
) -> Estimate:
    """Every site against the one at ``place``, whose normal ``known`` (3,) is given.

    Each site's four candidates are weighed against ``expected`` (R, C, 3), the map's normals (NaN: the
    reference's); the chosen ones, made one smooth surface, and the map's own are two starts of a fit to all
    moments at once, and the better is kept: or the plane through the reference, where it explains as much.
    """
    anchor = anchor_at(sites, place, known)
    flat = ~known_at(expected)
    guess = np.where(flat[..., None], known, expected)
    start = integrated(sites, guess, np.where(flat, 0.1, 1.0), anchor, stiffness.bend)
    chosen, clarity = _chosen(sites, start, anchor, guess)
    own = integrated(sites, chosen, sites.weight * (0.2 + clarity), anchor, stiffness.bend)
    flat_one = anchored_plane(sites, anchor)
    bent = (fitted(sites, corners, anchor, stiffness.bend, stiffness.rounds) for corners in (start, own))
    relief = min(bent, key=lambda one: one.cost)
    if _plain_enough(sites, flat_one, relief):
        relief = flat_one
    normals, anchor = relief.normals(sites), replace(anchor, surface=relief.surface)
    alone, _ = _alone(sites, relief.w, anchor, normals)
    return Estimate(
        normals, relief.residual, _eccentricity(anchor.surface), _angle(alone, normals), clarity, 0.0
    )


def as_plane(sites: Sites) -> Estimate:
    """The region as one plane; its own reference. The clarity is 1: perspective leaves one answer."""
    inside = sites.weight > 0
    at = Positions(sites.at.across[inside], sites.at.down[inside])
    plane = best_plane(sites.moments[inside], at, sites.weight[inside])
    w, a, b = plane.relief(sites.at)
    normals = normal_of_slopes(sites.at, a, b)
    residual = np.zeros((*sites.shape, 3))
    residual[inside] = plane.residual
    alone, _ = _alone(sites, w, Anchor((0, 0), (0.0, 0.0), plane.surface), normals)
    spread = float(np.sqrt(np.trace(plane.covariance)))
    return Estimate(
        normals, residual, _eccentricity(plane.surface), _angle(alone, normals), np.ones(sites.shape), spread
    )


def _plain_enough(sites: Sites, plane: Relief, bent: Relief) -> bool:
    """Whether the reference's plane explains the moments, or a bent surface not much better."""
    total, of_plane, of_bent = sites.weight.sum(), plane.misfit(sites), bent.misfit(sites)
    return bool(of_plane < 0.1 * total and of_plane < 1.5 * of_bent + 0.01 * total)


def _chosen(sites: Sites, corners: Array, anchor: Anchor, expected: Array) -> tuple[Array, Array]:
    w = (corners[:-1, :-1] + corners[:-1, 1:] + corners[1:, :-1] + corners[1:, 1:]) / 4
    return _alone(sites, w, anchor, expected)


def _alone(sites: Sites, w: Array, anchor: Anchor, expected: Array) -> tuple[Array, Array]:
    """Each site's nearest candidate (R, C, 3) and how clear the choice is."""
    level, ellipse = np.exp(anchor.surface[0]), np.exp(_eccentricity(anchor.surface))
    surface = Canonical(*(np.asarray(x) for x in (level * ellipse, level / ellipse, 0.0)))
    return nearest(normal_candidates(sites.moments, sites.at, w, surface), expected)


def _eccentricity(surface: Array) -> float:
    return float(np.hypot(surface[1], surface[2]))


def _angle(one: Array, other: Array) -> Array:
    return np.asarray(np.arccos(np.clip((one * other).sum(axis=-1), -1, 1)))
