"""The image of a perspective surface at a point: from image moments to moments on the surface and back.

A surface is given by its nearness w = 1/Z over image positions (U, V) = ((u−c_x)/f, (v−c_y)/f), and its
relative slopes a = w_U / w and b = w_V / w; a plane's w is linear. Nothing depends on the unit of w.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.transform import moments_under

__all__ = [
    "Positions",
    "log_moments",
    "normal_of_slopes",
    "slopes_of_normal",
    "surface_log_moments",
    "surface_moments",
    "to_surface",
]


class Positions(NamedTuple):
    """Image positions over the focal length, each (…)."""

    across: Array
    down: Array


def normal_of_slopes(at: Positions, a: Array, b: Array) -> Array:
    """Unit normals (…, 3) facing the camera: n ∝ −(a, b, 1 − Ua − Vb)."""
    normal = -np.stack([a, b, 1 - at.across * a - at.down * b], axis=-1)
    return np.asarray(normal / np.linalg.norm(normal, axis=-1, keepdims=True))


def slopes_of_normal(at: Positions, normals: Array) -> tuple[Array, Array]:
    """(a, b) of normals (…, 3); the inverse of :func:`normal_of_slopes`, kept within 87° of the ray."""
    x, y, z = np.moveaxis(normals, -1, 0)
    along = np.minimum(at.across * x + at.down * y + z, -0.05)
    return x / along, y / along


def to_surface(at: Positions, w: Array, a: Array, b: Array) -> Array:
    """B (…, 2, 2): image steps (dU, dV) to steps on the surface, in the unit of 1/w.

    The surface's axes are the image's, turned into the tangent plane by the shortest turn: the same all over
    a plane, and carried along without twist where a surface bends one way.
    """
    k = -normal_of_slopes(at, a, b)
    kx, ky, kz = np.moveaxis(k, -1, 0)
    twist = -kx * ky / (1 + kz)
    first = (1 - kx * kx / (1 + kz), twist, -kx)
    second = (twist, 1 - ky * ky / (1 + kz), -ky)
    rows = []
    for e in (first, second):
        along = e[0] * at.across + e[1] * at.down + e[2]
        rows.append(np.stack([e[0] - a * along, e[1] - b * along], axis=-1) / w[..., None])
    return np.stack(rows, axis=-2)


def surface_moments(moments: Array, at: Positions, w: Array, a: Array, b: Array) -> Array:
    """Moments (…, 3) on the surface of image moments (…, 3): those of B⁻ᵀ G B⁻¹."""
    (p, q), (r, s) = np.moveaxis(to_surface(at, w, a, b), (-2, -1), (0, 1))
    det = p * s - q * r
    inverse = np.stack([np.stack([s, -q], axis=-1), np.stack([-r, p], axis=-1)], axis=-2)
    return moments_under(moments, inverse / det[..., None, None])


def surface_log_moments(moments: Array, at: Positions, w: Array, a: Array, b: Array) -> Array:
    """:func:`log_moments` (…, 3) of :func:`surface_moments`."""
    return log_moments(surface_moments(moments, at, w, a, b))


def log_moments(moments: Array) -> Array:
    """(½ log det, ℓ cos 2θ, ℓ sin 2θ), ℓ = ½ log(M/m): the logarithm of the moments' matrix, (…, 3).

    Errors of measurement are about alike in the three, whatever the texture's scale.
    """
    x, xy, y = np.moveaxis(moments, -1, 0)
    half, spread = (x + y) / 2, np.hypot(x - y, xy) / 2
    det = np.maximum(half**2 - spread**2, 1e-6 * half**2)
    eccentricity = np.arctanh(np.minimum(spread / half, 1 - 1e-6))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(spread > 0, eccentricity / (2 * spread), 0)
    return np.stack([np.log(det) / 2, share * (x - y), share * xy], axis=-1)
