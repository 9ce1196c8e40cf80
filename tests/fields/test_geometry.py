"""Depth, disparity, positions and normals against surfaces whose every number is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from visint.fields import Camera, DepthEvidence, DisparityEvidence
from visint.fields.geometry import (
    back_project,
    depth_evidence,
    depth_from_disparity,
    disparity_evidence,
    disparity_from_depth,
    normals_from_depth,
    normals_from_slopes,
    pixel_grid,
    slopes_from_depth,
    slopes_from_normals,
)
from visint.testing import strategies

CAMERA = Camera(focal_length=120, cx=31.3, cy=22.8, baseline=50, width=64, height=48)
CONVERGING = CAMERA.model_copy(update={"doffs": 40.0})


def rays(camera):
    """The rays ((u−cx)/f, (v−cy)/f, 1) in double precision."""
    v, u = np.mgrid[: camera.height, : camera.width].astype(float)
    return np.stack(
        [(u - camera.cx) / camera.focal_length, (v - camera.cy) / camera.focal_length, np.ones_like(u)], -1
    )


def plane(camera, normal, distance=500.0):
    """Depth of the plane through (0, 0, distance) with this normal: Z = n_z d / n·r."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    return normal, (normal[2] * distance / (rays(camera) @ normal)).astype(np.float32)


def sphere(camera, centre=(0.0, 0.0, 500.0), radius=60.0):
    """Depth and unit normals of a sphere, NaN beside it."""
    r, centre = rays(camera), np.asarray(centre)
    a, b, c = (r * r).sum(-1), r @ centre, centre @ centre - radius**2
    with np.errstate(invalid="ignore"):
        depth = (b - np.sqrt(b**2 - a * c)) / a
    normals = (r * depth[..., None] - centre) / radius
    return depth.astype(np.float32), normals


def angles(first, second):
    """Radians between unit vectors, NaN where either is unknown."""
    cross = np.linalg.norm(np.cross(first, second), axis=-1)
    return np.arctan2(cross, (first * second).sum(-1))


TILTED = [(0, 0, -1), (0.3, -0.2, -1), (-1, 0, -1), (0.5, 1.5, -1), (2, 0.3, -1)]


class TestDepthAndDisparity:
    def test_known_answer(self):
        """Z = fB/(d + doffs) = 120·50/(20 + 40) = 100."""
        depth = depth_from_disparity(np.full((2, 2), 20, np.float32), CONVERGING)
        np.testing.assert_array_equal(depth, np.full((2, 2), 100, np.float32))

    @pytest.mark.parametrize("camera", [CAMERA, CONVERGING], ids=["parallel", "converging"])
    def test_there_and_back(self, camera):
        """Disparity → depth → disparity is the identity, negative disparities of converging rigs included."""
        lowest = -camera.doffs + 0.5
        disparity = np.linspace(lowest, 90, 300, dtype=np.float32).reshape(20, 15)
        depth = depth_from_disparity(disparity, camera)
        assert (depth > 0).all()
        assert depth.dtype == np.float32
        np.testing.assert_allclose(disparity_from_depth(depth, camera), disparity, rtol=2e-6, atol=2e-5)

    def test_infinity_and_behind_are_unknown(self):
        """d + doffs ≤ 0 has no depth, depth ≤ 0 no disparity, and NaN stays NaN."""
        disparity = np.array([[-40, -41, np.nan, -39]], np.float32)
        assert np.isnan(depth_from_disparity(disparity, CONVERGING)).tolist() == [[True, True, True, False]]
        depth = np.array([[0, -3, np.nan, 3]], np.float32)
        assert np.isnan(disparity_from_depth(depth, CONVERGING)).tolist() == [[True, True, True, False]]

    @pytest.mark.parametrize("shift", [1e-7, 1e-30, 1e-42])
    def test_almost_infinite_is_unknown_or_finite(self, shift):
        """A disparity a breath above infinity neither warns nor gives inf."""
        depth = depth_from_disparity(np.full((1, 1), shift, np.float32), CAMERA)
        assert not np.isinf(depth).any()
        near = disparity_from_depth(np.full((1, 1), shift, np.float32), CAMERA)
        assert not np.isinf(near).any()

    @given(strategies.cameras(size=(6, 7)), strategies.arrays("Disparity", (6, 7)))
    def test_what_is_unknown_stays_unknown_and_nothing_else(self, camera, disparity):
        depth = depth_from_disparity(disparity, camera)
        np.testing.assert_array_equal(np.isnan(depth), np.isnan(disparity))
        np.testing.assert_allclose(disparity_from_depth(depth, camera), disparity, rtol=1e-4, atol=1e-4)

    def test_inputs_may_be_read_only_and_stay(self):
        disparity = np.full((2, 3), 7, np.float32)
        disparity.flags.writeable = False
        depth_from_disparity(disparity, CAMERA)
        assert (disparity == 7).all()


class TestEvidence:
    def test_sigma_is_carried(self):
        """σ_Z = Z² σ_d / fB: at Z = 100, fB = 6000 and σ_d = 0.3 that is 0.5."""
        disparity = np.full((1, 3), 20, np.float32)
        given_ = DisparityEvidence.of(disparity, 0.3, 0.8)
        depth = depth_evidence(given_, CONVERGING)
        assert depth.value[0] == pytest.approx(100)
        assert depth.sigma[0] == pytest.approx(0.5)
        assert depth.reliability[0] == pytest.approx(0.8)
        back = disparity_evidence(depth, CONVERGING)
        np.testing.assert_allclose(back.value, disparity, rtol=1e-6)
        np.testing.assert_allclose(back.sigma, 0.3, rtol=1e-6)

    def test_sigma_agrees_with_the_spread_of_noisy_disparities(self):
        """10,000 disparities with σ = 0.1 px scatter in depth as the carried sigma says, within 3 %."""
        noise = np.random.default_rng(0).normal(30, 0.1, (100, 100)).astype(np.float32)
        spread = depth_from_disparity(noise, CAMERA).std()
        carried = depth_evidence(DisparityEvidence.of(np.full((1, 1), 30, np.float32), 0.1, 1.0), CAMERA)
        assert spread == pytest.approx(float(carried.sigma[0, 0]), rel=0.03)

    def test_it_abstains_where_there_is_no_depth(self):
        disparity = np.array([[-50, 0, np.nan, 1e-42]], np.float32)
        depth = depth_evidence(DisparityEvidence.of(disparity, 1.0, 1.0), CAMERA)
        assert (depth.reliability[0] == 0).tolist() == [True, True, True, True]

    @given(strategies.evidence("Depth", (4, 5)), strategies.cameras(size=(4, 5), doffs=0.0))
    def test_there_and_back_keeps_reliability(self, evidence, camera):
        assert isinstance(evidence, DepthEvidence)
        there = disparity_evidence(evidence, camera)
        again = depth_evidence(there, camera)
        np.testing.assert_array_equal(again.reliability, evidence.reliability)
        np.testing.assert_allclose(again.value, evidence.value, rtol=2e-3)


class TestPositions:
    def test_pixel_grid_broadcasts_to_the_image(self):
        across, down = pixel_grid(CAMERA)
        assert across.shape == (1, 64)
        assert down.shape == (48, 1)
        assert across.dtype == down.dtype == np.float32
        assert across[0, 31] == pytest.approx(-0.3, abs=1e-5)
        assert down[23, 0] == pytest.approx(0.2, abs=1e-5)

    def test_points_lie_on_the_plane(self):
        """n·X is the same for every point of a plane."""
        normal, depth = plane(CAMERA, (0.4, -0.3, -1))
        along = back_project(depth, CAMERA) @ normal
        np.testing.assert_allclose(along, normal[2] * 500, rtol=1e-6)

    def test_points_lie_on_the_sphere(self):
        depth, _ = sphere(CAMERA)
        away = np.linalg.norm(back_project(depth, CAMERA) - [0, 0, 500], axis=-1)
        np.testing.assert_allclose(away[np.isfinite(depth)], 60, rtol=1e-4)

    def test_the_principal_point_is_on_the_axis(self):
        camera = CAMERA.model_copy(update={"cx": 10.0, "cy": 20.0})
        depth = np.full(camera.size, 7, np.float32)
        points = back_project(depth, camera)
        assert points[20, 10].tolist() == [0, 0, 7]
        assert points[20, 11, 0] > 0
        assert points[21, 10, 1] > 0
        assert points.dtype == np.float32


class TestSlopes:
    def test_central_inside_one_sided_at_the_edge(self):
        """Of Z = u²: 2u inside, the one-sided step at either end."""
        depth = np.tile(np.arange(5, dtype=np.float32) ** 2, (3, 1))
        slopes = slopes_from_depth(depth)
        assert slopes[1, :, 0].tolist() == [1, 2, 4, 6, 7]
        assert (slopes[..., 1] == 0).all()

    def test_a_hole_is_bridged_by_nobody(self):
        """Beside a hole differences are one-sided; in it, and where no neighbour is known, NaN."""
        depth = np.array([[1, 2, np.nan, 8, np.nan]] * 2, np.float32)
        across = slopes_from_depth(depth)[0, :, 0]
        np.testing.assert_array_equal(across, [1, 1, np.nan, np.nan, np.nan])

    @pytest.mark.parametrize("shape", [(1, 6), (6, 1), (1, 1)])
    def test_single_rows_and_columns(self, shape):
        slopes = slopes_from_depth(np.arange(6, dtype=np.float32)[: shape[0] * shape[1]].reshape(shape))
        assert slopes.shape == (*shape, 2)
        for axis in (0, 1):
            assert np.isnan(slopes[..., axis]).all() == (shape[1 - axis] == 1)


class TestNormals:
    @pytest.mark.parametrize("direction", TILTED)
    @pytest.mark.parametrize("level", [0, 3])
    def test_of_a_plane_from_its_slopes(self, direction, level):
        """With the analytic slopes Z_u = −Z n_x/(f n·r) the normal is exact."""
        camera = CAMERA
        for _ in range(level):
            camera = camera.halved()
        normal, depth = plane(camera, direction)
        along = rays(camera) @ normal
        slopes = (-depth[..., None] * normal[:2] / (camera.focal_length * along[..., None])).astype(np.float32)
        found = normals_from_slopes(depth, slopes, camera)
        visible = along < 0
        assert angles(found, normal)[visible].max() < 1e-5
        assert found.dtype == np.float32

    @pytest.mark.parametrize("direction", TILTED)
    @pytest.mark.parametrize("level", [0, 3])
    def test_of_a_plane_from_depth(self, direction, level):
        """Exact for every plane in front of the camera, at its border and on coarse levels too."""
        camera = CAMERA
        for _ in range(level):
            camera = camera.halved()
        normal, depth = plane(camera, direction)
        depth = np.where(rays(camera) @ normal < -0.05, depth, np.float32(np.nan))
        found = normals_from_depth(depth, camera)
        seen = np.isfinite(found[..., 0])
        assert seen.sum() > 0.9 * np.isfinite(depth).sum()
        assert angles(found, normal)[seen].max() < 2e-4

    def test_of_a_sphere(self):
        """Within 0.5° on average and 3° at most where the surface is not seen edge-on (slant < 60°)."""
        depth, truth = sphere(CAMERA)
        found = normals_from_depth(depth, CAMERA)
        r = rays(CAMERA)
        slant = -(truth * r).sum(-1) / np.linalg.norm(r, axis=-1)
        error = np.degrees(angles(found, truth))[slant > 0.5]
        assert np.isfinite(error).all()
        assert error.mean() < 0.5
        assert error.max() < 3

    def test_of_a_finer_sphere(self):
        """The error falls with the square of the resolution."""
        means = []
        for scale in (1, 2, 4):
            camera = Camera(
                focal_length=120 * scale,
                cx=32 * scale - 0.5,
                cy=24 * scale - 0.5,
                baseline=50,
                width=64 * scale,
                height=48 * scale,
            )
            depth, truth = sphere(camera)
            r = rays(camera)
            inside = -(truth * r).sum(-1) / np.linalg.norm(r, axis=-1) > 0.8
            means.append(np.nanmean(angles(normals_from_depth(depth, camera), truth)[inside]))
        assert means[0] / means[1] > 3
        assert means[1] / means[2] > 3

    def test_they_face_the_camera(self):
        depth, _ = sphere(CAMERA)
        found = normals_from_depth(depth, CAMERA)
        known = np.isfinite(found[..., 0])
        assert (found[known][:, 2] < 0).all()
        np.testing.assert_allclose(np.linalg.norm(found[known], axis=-1), 1, rtol=1e-6)

    def test_fronto_parallel_is_exactly_towards_the_camera(self):
        found = normals_from_depth(np.full(CAMERA.size, 300, np.float32), CAMERA)
        np.testing.assert_array_equal(found, np.broadcast_to(np.float32([0, 0, -1]), found.shape))

    @pytest.mark.parametrize("bad", [np.nan, 0.0, -5.0, 1e-42])
    def test_unknown_depth_has_no_normal(self, bad):
        """Not known, at the camera or behind it: no normal, and no warning either."""
        depth = np.full(CAMERA.size, 300, np.float32)
        depth[10, 10] = bad
        found = normals_from_depth(depth, CAMERA)
        assert np.isnan(found[10, 10]).all()
        assert np.isfinite(found[0, 0]).all()

    def test_nothing_known(self):
        assert np.isnan(normals_from_depth(np.full(CAMERA.size, np.nan, np.float32), CAMERA)).all()

    @given(st.tuples(*[st.floats(-1.0, 1.0)] * 2), strategies.cameras(size=(9, 12)))
    def test_slopes_and_normals_are_inverse(self, direction, camera):
        """slopes → normals → slopes, and normals → slopes → normals, wherever the surface is seen."""
        normal, depth = plane(camera, (*direction, -2.0), distance=100)
        normals = np.broadcast_to(normal.astype(np.float32), (*camera.size, 3))
        slopes = slopes_from_normals(depth, normals, camera)
        seen = (rays(camera) @ normal < -0.05) & (depth > 0)
        np.testing.assert_array_less(angles(normals_from_slopes(depth, slopes, camera), normals)[seen], 1e-4)
        again = slopes_from_normals(depth, normals_from_slopes(depth, slopes, camera), camera)
        np.testing.assert_allclose(again[seen], slopes[seen], rtol=1e-3, atol=1e-4 * np.abs(slopes[seen]).max())

    def test_from_behind_there_are_no_slopes(self):
        depth = np.full(CAMERA.size, 100, np.float32)
        away = np.broadcast_to(np.float32([0, 0, 1]), (*CAMERA.size, 3))
        assert np.isnan(slopes_from_normals(depth, away, CAMERA)).all()
