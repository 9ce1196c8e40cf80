"""How an affine map changes second moments: the matrix T of Eq. 5.86, and the maps A of section 3.5.

Moments are (g_x, 2E[u_x u_y], g_y), the order in which Eq. 5.86 is right; Eqs. 5.85 to
5.88 name them in another one.
"""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["affine", "affine_parts", "image_from_surface", "moments_under", "surface_from_image"]


def surface_from_image(slant: Array, tilt: Array) -> Array:
    """T (…, 3, 3) of Eq. 5.86: surface moments = T · image moments, along (tilt, across the tilt).

    ``slant`` and ``tilt`` are (…) in radians. The surface's axes are the tilt direction as it lies on the
    surface and the direction across it.
    """
    cos_slant, c, s = np.cos(slant), np.cos(tilt), np.sin(tilt)
    rows = (
        (cos_slant**2 * c * c, cos_slant**2 * c * s, cos_slant**2 * s * s),
        (-2 * cos_slant * c * s, cos_slant * (c * c - s * s), 2 * cos_slant * c * s),
        (s * s, -c * s, c * c),
    )
    return _matrix(rows)


def image_from_surface(slant: Array, tilt: Array) -> Array:
    """The inverse of :func:`surface_from_image`, (…, 3, 3)."""
    c, s = np.cos(tilt), np.sin(tilt)
    k = 1 / np.cos(slant)
    rows = (
        (k * k * c * c, -k * c * s, s * s),
        (2 * k * k * c * s, k * (c * c - s * s), -2 * c * s),
        (k * k * s * s, k * c * s, c * c),
    )
    return _matrix(rows)


def moments_under(moments: Array, matrix: Array) -> Array:
    """Image moments (…, 3) of a texture with surface ``moments`` (…, 3) where image points x lie at A x on it.

    ``matrix`` is A (…, 2, 2). Frequencies go as u = Aᵀ u_s, so E[u uᵀ] goes as Aᵀ G A.
    """
    (a, b), (c, d) = np.moveaxis(matrix, (-2, -1), (0, 1))
    x, xy, y = np.moveaxis(moments, -1, 0)
    return np.stack(
        [
            a * a * x + a * c * xy + c * c * y,
            2 * a * b * x + (a * d + b * c) * xy + 2 * c * d * y,
            b * b * x + b * d * xy + d * d * y,
        ],
        axis=-1,
    )


def affine(scale: Array, rotation: Array, stretch: Array, axis: Array) -> Array:
    """A = S(s) R(θ) D(α, μ), (…, 2, 2): section 3.5, its lower right being α sin²μ + cos²μ / α."""
    c, s = np.cos(axis), np.sin(axis)
    off = (stretch - 1 / stretch) * s * c
    shear = _matrix(((s * s / stretch + stretch * c * c, off), (off, stretch * s * s + c * c / stretch)))
    turn = _matrix(((np.cos(rotation), -np.sin(rotation)), (np.sin(rotation), np.cos(rotation))))
    return np.asarray(np.asarray(scale)[..., None, None] * (turn @ shear))


def affine_parts(matrix: Array) -> tuple[Array, Array, Array, Array]:
    """(s, θ, α, μ) of affine maps (…, 2, 2) of positive determinant: α ≥ 1, μ in (−π/2, π/2].

    The polar decomposition; where α is 1 there is no axis and μ is 0.
    """
    (a, b), (c, d) = np.moveaxis(matrix, (-2, -1), (0, 1))
    scale = np.sqrt(a * d - b * c)
    rotation = np.arctan2(c - b, a + d)
    # MᵀM = s² R(μ) diag(α², 1/α²) R(μ)ᵀ
    x, xy, y = a * a + c * c, a * b + c * d, b * b + d * d
    spread = np.hypot(x - y, 2 * xy)
    stretch = np.sqrt((x + y + spread) / 2) / scale
    return scale, rotation, stretch, np.arctan2(2 * xy, x - y) / 2


def _matrix(rows: tuple[tuple[Array, ...], ...]) -> Array:
    return np.stack([np.stack(np.broadcast_arrays(*row), axis=-1) for row in rows], axis=-2)
