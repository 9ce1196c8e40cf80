"""Normals turned onto the cone of one brightness around the light."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["onto_cone"]


def onto_cone(normals: Array, light: Array, cosine: Array) -> tuple[Array, Array]:
    """The nearest normals to ``normals`` (H, W, 3) whose cosine to ``light`` (H, W, 3) is ``cosine`` (H, W).

    Each is turned in the plane it spans with the light: direction from the surface, magnitude from brightness.
    A normal along the light itself has no such plane and stays there.

    Returns
    -------
    float32 (H, W, 3) unit normals, NaN where ``normals`` or ``cosine`` is unknown or the cone faces away from
    the camera; float32 (H, W), the sine between the given normal and the light: how clear the direction was.
    """
    from visint_shading import _kernels

    found = np.empty(normals.shape, np.float32)
    clear = np.empty(cosine.shape, np.float32)
    _kernels.turned(normals, light, cosine, found, clear)
    return found, clear
