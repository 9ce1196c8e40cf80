"""Along each pixel's own ray the projection is orthographic: there Super and Bovik's relations hold."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.canonical import Canonical, canonical
from visint_texture.geometry.orientation import candidates
from visint_texture.geometry.tangent import Positions, slopes_of_normal, surface_moments

__all__ = ["normal_candidates"]


def normal_candidates(moments: Array, at: Positions, w: Array, surface: Canonical) -> Array:
    """The four unit normals (…, 4, 3), camera frame, that image moments (…, 3) at nearness ``w`` (…) allow.

    The moments are brought to a small screen across each ray at the surface's distance; slant and tilt of
    Eqs. 5.89 to 5.93 are then about the ray. ``surface`` holds the texture's canonical moments.
    """
    length = np.sqrt(1 + at.across**2 + at.down**2)
    ray = np.stack([at.across, at.down, np.ones_like(at.across)], axis=-1) / length[..., None]
    screen = surface_moments(moments, at, w, *slopes_of_normal(at, -ray))
    about_rays = candidates(canonical(screen), surface).normals
    x, y, z = np.moveaxis(ray, -1, 0)
    twist = -x * y / (1 + z)
    first = np.stack([1 - x * x / (1 + z), twist, -x], axis=-1)
    second = np.stack([twist, 1 - y * y / (1 + z), -y], axis=-1)
    return np.asarray(about_rays @ np.stack([first, second, ray], axis=-2))
