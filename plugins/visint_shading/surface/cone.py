"""Normals turned onto the cone of one brightness around the light."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["onto_cone"]


def onto_cone(normals: Array, light: Array, cosine: Array) -> tuple[Array, Array]:
    """The nearest normals to ``normals`` (H, W, 3) whose cosine to ``light`` is ``cosine`` (H, W).

    Each is turned in the plane it spans with the light: direction from the surface, magnitude from brightness.
    A normal along the light itself has no such plane and stays there.

    Returns
    -------
    float32 (H, W, 3) unit normals, NaN where ``normals`` or ``cosine`` is unknown or the cone faces away from
    the camera; float32 (H, W), the sine between the given normal and the light: how clear the direction was.
    """
    towards = (normals * light).sum(axis=-1, keepdims=True)
    aside = normals - towards * light
    clear = np.sqrt((aside * aside).sum(axis=-1, keepdims=True))
    with np.errstate(divide="ignore", invalid="ignore"):
        aside = np.where(clear > 1e-6, aside / clear, 0)
        c = np.clip(cosine, -1, 1)[..., None]
        turned = c * light + np.sqrt(1 - c * c) * aside
        turned = turned / np.sqrt((turned * turned).sum(axis=-1, keepdims=True))
        seen = np.where(turned[..., 2:] < 0, turned, np.nan)
    return seen.astype(np.float32), clear[..., 0].astype(np.float32)
