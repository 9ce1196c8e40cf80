"""The surface of a depth map: which neighbours are joined, and that it faces the camera."""

from __future__ import annotations

import io

import numpy as np
import pytest

from visint import Camera
from visint.fields import geometry
from visint.results.solid import faces_of

CAMERA = Camera(focal_length=100, cx=4, cy=3, baseline=10, width=9, height=7)


def test_a_wall_is_two_triangles_a_square_facing_the_camera():
    """(7 − 1)(9 − 1) squares; every normal points to −z."""
    depth = np.full((7, 9), 50, np.float32)
    faces = faces_of(depth, CAMERA)
    assert faces.shape == (2 * 6 * 8, 3)
    corners = geometry.back_project(depth, CAMERA).reshape(-1, 3)[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] < 0).all()
    assert np.abs(normals[:, :2]).max() < 1e-3
    area = np.linalg.norm(normals, axis=1).sum() / 2
    assert area == pytest.approx(6 * 8 * (50 / 100) ** 2, rel=1e-5)


def test_unknown_pixels_leave_a_hole():
    """The six triangles around one pixel go, no others."""
    depth = np.full((7, 9), 50, np.float32)
    depth[3, 4] = np.nan
    assert len(faces_of(depth, CAMERA)) == 96 - 6


def test_a_step_is_torn_and_a_slope_is_not():
    """A wall before another one: the column between them is left open. A plane of 80° slant stays whole."""
    depth = np.full((7, 9), 50, np.float32)
    depth[:, 5:] = 80
    assert len(faces_of(depth, CAMERA)) == 2 * 6 * 7
    slope = (50 * (1 + np.tan(np.radians(80)) * np.arange(9) / 100))[None].repeat(7, 0).astype(np.float32)
    assert len(faces_of(slope, CAMERA)) == 2 * 6 * 8


def test_whole_steps_of_disparity_far_away_are_joined():
    """Disparities 2 and 3 are 500 and 333: a staircase of the matcher, not of the scene."""
    depth = np.full((7, 9), 1000 / 2, np.float32)
    depth[:, 5:] = 1000 / 3
    assert len(faces_of(depth, CAMERA)) == 2 * 6 * 8


def test_a_result_brings_its_surface(tmp_path):
    """Read by trimesh: in metres, y up, its colours those of the picture, no larger than the limit."""
    trimesh = pytest.importorskip("trimesh")
    import visint
    from visint.results.artifacts import files_of

    image = np.random.default_rng(0).random((40, 60), np.float32)
    camera = CAMERA.model_copy(update={"width": 50, "height": 40, "disparity_range": (0, 9)})
    result = visint.run("stereo_sgm", left=image[:, :50], right=image[:, 5:55], camera=camera)
    files = dict(files_of(result))
    scene = trimesh.load(io.BytesIO(files["surface.glb"]), file_type="glb", process=False)
    mesh = scene.to_mesh()
    assert len(mesh.faces) > 1000
    depth = result["depth"][np.isfinite(result["depth"])]
    assert -mesh.vertices[:, 2].min() * 1000 == pytest.approx(depth.max(), rel=1e-5)
    assert np.median(-mesh.vertices[:, 2]) * 1000 == pytest.approx(np.median(depth), rel=0.05)
