"""The energy of the joint estimate, and its minimum by Gauss-Newton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint_bayes.joint.brightness import Brightness, SlopeTerm, slope_term
from visint_bayes.joint.domain import Domain
from visint_bayes.joint.multigrid import Multigrid
from visint_bayes.joint.photometry import Views, data_term

__all__ = ["Recipe", "Setting", "bends_of", "data_precision", "minimum", "slopes_of"]


@dataclass(frozen=True, slots=True)
class Recipe:
    """What makes one candidate differ from another.

    Parameters
    ----------
    anchor
        Weight of the stereo's own disparity, px⁻²: more keeps closer to it.
    shading
        Weight of brightness, 1 being what its noise alone would give it.
    plate
        Weight of bending, for an object of 256-pixel images: more is smoother. It grows with the size.
    crease
        Bending beyond this, px per px² in 256-pixel images, is taken for a crease and let go.
    slant
        Power of the slant's cosine that plate and bending are scaled by: 0 makes the plate that of the image, 4
        that of the surface, which lets round things turn away at their limbs but holds slanted faces less flat.
    turns
        Linearisations.
    tolerance
        Each linear system is solved to this part of its right side.
    """

    anchor: float
    shading: float = 0.0
    plate: float = 100.0
    crease: float = 0.1
    slant: float = 0.0
    turns: int = 4
    tolerance: float = 0.1


@dataclass(frozen=True, slots=True)
class Setting:
    """All that the energy is about; maps (H, W).

    Parameters
    ----------
    stereo
        float32, px, complete: where the surface is anchored.
    gap
        float32, px: how much nearer the right view's surface is where the anchor leads.
    hidden
        bool: the right view does not see it; anchored firmly for want of anything better.
    unseen
        bool: what neither view can be trusted with, highlights; neither data nor anchor.
    adrift
        bool: near a depth edge, where stereo smooths over it; hardly anchored.
    brightness
        What shading knows; None without a light.
    zoom
        Width of the object's image by that of the same at 256 pixels.
    hold
        Least weight of the anchor on what the right view does not see, px⁻².
    """

    domain: Domain
    views: Views
    stereo: Array
    gap: Array
    hidden: Array
    unseen: Array
    adrift: Array
    camera: Camera
    brightness: Brightness | None = None
    zoom: float = 1.0
    hold: float = 0.3


TURNING = 4.0
"""What the right view does not see is turning away: its plate is that of the surface."""
ADRIFT = 1e-4
"""The anchor's weight where stereo smooths over a depth edge, px⁻²."""
WEAKEST = 1e-7
"""Keeps a piece without any data where it is."""


class _System(NamedTuple):
    """The energy's quadratic model around a surface, inside a box."""

    box: tuple[slice, slice]
    domain: Domain
    matrix: Array
    pull: Array


def slopes_of(domain: Domain, surface: Array) -> Array:
    """(H, W, 2): d_u and d_v inside the domain."""
    from visint_bayes.joint import _kernels

    out = np.empty((*surface.shape, 2))
    _kernels.slopes(domain.inside, domain.across, domain.down, surface, out)
    return out


def bends_of(domain: Domain, surface: Array) -> Array:
    """(H, W, 3): d_uu, d_vv, d_uv inside the domain."""
    from visint_bayes.joint import _kernels

    out = np.empty((*surface.shape, 3))
    _kernels.bends(domain.inside, domain.across, domain.down, surface, out)
    return out


def minimum(setting: Setting, recipe: Recipe, start: Array | None = None) -> Array:
    """The disparity (H, W), float64, that minimises the energy; outside the domain the start."""
    surface = (setting.stereo if start is None else start).astype(np.float64)
    for _ in range(recipe.turns):
        system = _linearised(setting, recipe, surface)
        solver = Multigrid(system.matrix, system.domain.pieces)
        surface = surface.copy()
        surface[system.box] += solver.solve(system.pull, recipe.tolerance)
    return surface


def data_precision(setting: Setting, surface: Array) -> Array:
    """(H, W): weight of the photometric data at a surface, px⁻², 0 outside the domain."""
    weight = data_term(setting.views, surface, setting.gap).weight
    return np.where(setting.domain.inside & ~setting.unseen, weight, 0)


def _linearised(setting: Setting, recipe: Recipe, surface: Array) -> _System:
    from visint_bayes.joint import _kernels

    box = setting.domain.box
    domain = setting.domain.cut_out(box)
    joined = (domain.inside, domain.across, domain.down)
    weight, pull = _pulls(setting, recipe, surface, box)
    bent = bends_of(domain, surface[box])
    slopes = slopes_of(setting.domain, surface)
    own = np.where(setting.hidden, TURNING, recipe.slant)
    plate = _plate(recipe, setting.zoom, bent, (_facing(setting, surface, slopes) ** own)[box])
    term = slope_term(setting.brightness, recipe.shading, surface, slopes, setting.camera)
    matrix = np.zeros((*domain.inside.shape, 25), np.float32)
    rows = np.ascontiguousarray(term.rows[box])
    _kernels.assemble(*joined, weight, *plate, rows, matrix)
    bending = np.zeros(pull.shape)
    _kernels.add_bend_terms(domain.inside, *plate, bent, bending)
    _add(joined, SlopeTerm(rows, np.ascontiguousarray(term.wanted[box])), pull)
    return _System(box, domain, matrix, pull - bending)


def _add(joined: tuple[Array, Array, Array], term: SlopeTerm, pull: Array) -> None:
    from visint_bayes.joint import _kernels

    _kernels.add_slope_terms(*joined, term.rows, term.wanted, pull)


def _pulls(setting: Setting, recipe: Recipe, surface: Array, box: tuple[slice, slice]) -> tuple[Array, Array]:
    """Weight (px⁻²) of what pulls at single pixels, and the pull; inside the box."""
    data = data_term(setting.views, surface, setting.gap)
    seen = np.where(setting.unseen, np.float32(0), np.float32(1))
    anchor = np.where(setting.hidden, np.maximum(recipe.anchor, setting.hold), recipe.anchor) * seen
    anchor = np.where(setting.adrift, ADRIFT, anchor)
    trust = data.weight * seen
    pull = trust * (data.target - surface) + anchor * (setting.stereo - surface)
    inside = setting.domain.inside[box]
    weight = np.where(inside, (trust + anchor)[box] + WEAKEST, 0).astype(np.float32)
    return weight, np.where(inside, pull[box], 0).astype(np.float64)


def _facing(setting: Setting, surface: Array, slopes: Array) -> Array:
    """(H, W): cosine of the slant, from a little above 0."""
    depth = np.maximum(surface + setting.camera.doffs, 1)
    steep = (slopes**2).sum(axis=-1) * (setting.camera.focal_length / depth) ** 2
    return np.asarray(1 / np.sqrt(1 + np.minimum(steep, 400)))


def _plate(recipe: Recipe, zoom: float, bent: Array, own: Array) -> tuple[Array, Array, Array]:
    """Weights of the three bending terms: of the surface's own curvature, and less at creases."""
    bending = (bent[..., 0] ** 2 + bent[..., 1] ** 2 + 2 * bent[..., 2] ** 2) * (zoom / recipe.crease) ** 2
    weight = (recipe.plate * zoom**2 * own / (1 + own * bending) ** 2).astype(np.float32)
    return weight, weight, weight
