"""The camera: its geometry at every level, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from pydantic import ValidationError

from visint.fields import Camera
from visint.fields.geometry import back_project, depth_from_disparity
from visint.fields.resampling import block_mean, smaller
from visint.testing import strategies

CAMERA = Camera(
    focal_length=100, cx=31.5, cy=20.25, baseline=50, width=64, height=42, doffs=12, disparity_range=(-4, 28)
)


class TestLevels:
    def test_halved(self):
        """Factor exactly 2; the principal point maps as every pixel centre, (x + ½)/2 − ½."""
        half = CAMERA.halved()
        assert (half.focal_length, half.doffs, half.disparity_range) == (50, 6, (-2, 14))
        assert (half.cx, half.cy) == (15.5, 9.875)
        assert half.size == (21, 32)
        assert (half.baseline, half.unit) == (50, "mm")

    @given(strategies.cameras())
    def test_doubled_undoes_halved(self, camera):
        """Odd sizes too, since the finer size is given."""
        again = camera.halved().doubled(camera.size)
        assert again.size == camera.size
        for name in ("focal_length", "cx", "cy", "doffs", "baseline"):
            assert getattr(again, name) == pytest.approx(getattr(camera, name), abs=1e-9)
        assert (again.disparity_range is None) == (camera.disparity_range is None)

    @given(strategies.cameras())
    def test_sizes_are_those_of_the_images(self, camera):
        assert camera.halved().size == smaller(camera.size)

    def test_a_plane_is_the_same_plane_at_every_level(self):
        """Back-projected means of blocks lie on the plane whose points were averaged (fronto-parallel)."""
        camera = CAMERA.model_copy(update={"width": 64, "height": 48})
        depth = np.full(camera.size, 300, np.float32)
        points, coarse = back_project(depth, camera), camera
        for _ in range(4):
            coarse, depth = coarse.halved(), block_mean(depth)
            points = block_mean(points)
            np.testing.assert_allclose(back_project(depth, coarse), points, atol=1e-3)

    def test_depth_of_a_disparity_is_the_same_at_every_level(self):
        """d, f and doffs halve together, so Z = fB/(d + doffs) stays."""
        disparity = np.full((4, 4), 20, np.float32)
        camera = CAMERA
        wanted = depth_from_disparity(disparity, camera)[0, 0]
        for level in range(1, 5):
            camera = camera.halved()
            assert depth_from_disparity(disparity / 2**level, camera)[0, 0] == pytest.approx(wanted)


class TestFacts:
    def test_uncalibrated(self):
        camera = Camera.uncalibrated(640, 480, (0, 64))
        assert not camera.calibrated
        assert (camera.cx, camera.cy) == (319.5, 239.5)
        assert camera.size == (480, 640)
        field_of_view = 2 * np.degrees(np.arctan(camera.width / 2 / camera.focal_length))
        assert field_of_view == pytest.approx(53, abs=0.2)

    def test_middle_disparity(self):
        assert CAMERA.middle_disparity == 12
        assert Camera.uncalibrated(4, 4).middle_disparity is None
        assert CAMERA.calibrated

    def test_it_is_frozen_and_hashable(self):
        with pytest.raises(ValidationError, match="frozen"):
            CAMERA.cx = 3
        assert hash(CAMERA) == hash(CAMERA.model_copy())

    def test_it_survives_json(self):
        """As a run record keeps it."""
        assert Camera.model_validate_json(CAMERA.model_dump_json()) == CAMERA


@pytest.mark.parametrize(
    "wrong",
    [
        {"focal_length": 0},
        {"focal_length": float("nan")},
        {"baseline": -1},
        {"width": 0},
        {"cx": float("inf")},
        {"doffs": float("nan")},
        {"disparity_range": (0, float("inf"))},
        {"disparity_range": (8, 2)},
        {"focal": 3},
    ],
    ids=str,
)
def test_nonsense_is_refused(wrong):
    """A calibration that cannot be: zero, negative, not finite, the range the wrong way round, misspelled."""
    with pytest.raises(ValidationError):
        Camera.model_validate({**CAMERA.model_dump(), **wrong})
