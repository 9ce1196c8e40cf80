"""Slant and tilt from canonical moments and those of a site whose orientation is known (Eqs. 5.89 to 5.93)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.canonical import Canonical

__all__ = ["Candidates", "candidates", "nearest", "normal_of", "slant_and_tilt", "wrapped"]


class Candidates(NamedTuple):
    """Slant (…) in [0, π/2) and the four tilts (…, 4) in (−π, π] that the moments allow."""

    slant: Array
    tilts: Array

    @property
    def normals(self) -> Array:
        """Unit normals (…, 4, 3) facing the camera."""
        return normal_of(self.slant[..., None], self.tilts)


def candidates(image: Canonical, surface: Canonical) -> Candidates:
    """Where the image's canonical moments (…) come from, given those on the surface (broadcastable).

    cos σ = √(M_s m_s / (M m)) (Eq. 5.89); τ = θ ± ½ arccos λ (+ π) (Eq. 5.92) with
    λ = ((cos²σ + 1)(M + m) − 2(M_s + m_s)) / (sin²σ (M − m)), M and m at the site itself (Eq. 5.93).
    Slant is 0 where the moments are smaller than on the surface; λ is held within ±1. Orthographic: for
    perspective scale the image's moments first.
    """
    product = image.largest * image.smallest
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = np.sqrt(surface.largest * surface.smallest / product)
        cosine = np.where(np.isfinite(cosine), np.minimum(cosine, 1), 1)
        top = (cosine**2 + 1) * (image.largest + image.smallest) - 2 * (surface.largest + surface.smallest)
        ratio = top / ((1 - cosine**2) * (image.largest - image.smallest))
    half = np.arccos(np.clip(np.where(np.isfinite(ratio), ratio, 1), -1, 1)) / 2
    first, second = image.orientation + half, image.orientation - half
    tilts = np.stack([first, second, first + np.pi, second + np.pi], axis=-1)
    return Candidates(np.arccos(cosine), wrapped(tilts))


def nearest(normals: Array, expected: Array) -> tuple[Array, Array]:
    """The one of ``normals`` (…, 4, 3) nearest to ``expected`` (…, 3), and how clear the choice is.

    Clarity in [0, 1] is the angle by which the next *other* candidate is farther, over the angle between the
    two: 0 where both are as far, and where there is no slant to choose a tilt for.
    """
    angles = np.arccos(np.clip(np.einsum("...ki,...i->...k", normals, expected), -1, 1))
    place = angles.argmin(axis=-1)
    chosen = np.take_along_axis(normals, place[..., None, None], axis=-2)[..., 0, :]
    apart = np.arccos(np.clip(np.einsum("...ki,...i->...k", normals, chosen), -1, 1))
    # The four are two pairs when λ = ±1; a twin of the chosen one is no rival.
    rivals = np.where(apart > np.deg2rad(3), angles, np.inf)
    rival = rivals.argmin(axis=-1)[..., None]
    gap = np.take_along_axis(rivals, rival, axis=-1)[..., 0] - angles.min(axis=-1)
    between = np.maximum(np.take_along_axis(apart, rival, axis=-1)[..., 0], np.deg2rad(10))
    return chosen, np.where(np.isfinite(gap), np.clip(gap / between, 0, 1), 0)


def normal_of(slant: Array, tilt: Array) -> Array:
    """Unit normals (…, 3) facing the camera: (sin σ cos τ, sin σ sin τ, −cos σ).

    Eqs. 5.90 and 5.91 with the factor sin σ that they miss, and our z, which points away from the camera.
    """
    slant, tilt = np.broadcast_arrays(slant, tilt)
    return np.stack([np.sin(slant) * np.cos(tilt), np.sin(slant) * np.sin(tilt), -np.cos(slant)], axis=-1)


def slant_and_tilt(normals: Array) -> tuple[Array, Array]:
    """(slant, tilt) of unit normals (…, 3): slant in [0, π/2), tilt in (−π, π] from +x towards +y."""
    sideways = np.hypot(normals[..., 0], normals[..., 1])
    return np.arctan2(sideways, -normals[..., 2]), np.arctan2(normals[..., 1], normals[..., 0])


def wrapped(angle: Array) -> Array:
    """The same angle in (−π, π]."""
    return -(np.mod(-angle + np.pi, 2 * np.pi) - np.pi)
