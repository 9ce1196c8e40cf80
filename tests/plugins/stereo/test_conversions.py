"""Disparity to depth to normals and back, as nodes."""

from __future__ import annotations

import numpy as np

from visint.fields import Camera
from visint.module import Context
from visint_stereo.conversions import (
    DepthAndCamera,
    DepthFromDisparity,
    DisparityAndCamera,
    DisparityFromDepth,
    NormalsFromDepth,
)

CAMERA = Camera(focal_length=100, cx=9.5, cy=7.5, baseline=2, width=20, height=16, doffs=3)


def test_disparity_and_depth_are_inverse():
    """Z = f B / (d + doffs), there and back; what is unknown stays unknown."""
    disparity = np.linspace(1, 30, 320, dtype=np.float32).reshape(16, 20).copy()
    disparity[3, 4] = np.nan
    depth = DepthFromDisparity().run(DisparityAndCamera(disparity=disparity, camera=CAMERA), Context()).depth
    assert np.isclose(depth[0, 0], 100 * 2 / (1 + 3))
    back = DisparityFromDepth().run(DepthAndCamera(depth=depth, camera=CAMERA), Context()).disparity
    np.testing.assert_allclose(back, disparity, rtol=1e-5)


def test_a_wall_faces_the_camera():
    """Constant depth: the normal is (0, 0, -1) everywhere."""
    depth = np.full((16, 20), 50, np.float32)
    normals = NormalsFromDepth().run(DepthAndCamera(depth=depth, camera=CAMERA), Context()).normals
    np.testing.assert_allclose(normals, np.broadcast_to([0, 0, -1], (16, 20, 3)), atol=1e-6)
