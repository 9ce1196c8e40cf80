"""The exact truth of a rendered pair, registered to its left view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visint.arrays import Array

__all__ = ["Truth"]


@dataclass(frozen=True, eq=False)
class Truth:
    """What ray casting through the pixel centres says. Maps are (H, W); unknown is NaN.

    Parameters
    ----------
    depth, depth_right
        float32, unit of the baseline, along the optical axis.
    normals
        float32 (H, W, 3), facing the camera.
    disparity, disparity_right
        float32, pixels, both counted as x_left − x_right.
    visible, visible_right
        bool: the surface point is seen by the other camera too, within its image.
    foreground
        bool: a thing is there.
    regions
        int32: one label a visible smooth patch, the background included; from 1.
    albedo
        float32, 0 in the background.
    lit
        bool: the light reaches the point.
    edges
        uint8: see :mod:`visint_lab.render.edges`.
    """

    depth: Array
    depth_right: Array
    normals: Array
    disparity: Array
    disparity_right: Array
    visible: NDArray[np.bool_]
    visible_right: NDArray[np.bool_]
    foreground: NDArray[np.bool_]
    regions: NDArray[np.int32]
    albedo: Array
    lit: NDArray[np.bool_]
    edges: NDArray[np.uint8]
