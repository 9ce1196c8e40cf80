"""Rectification: what the rectified camera would see, by following rays to a wall that is known."""

from __future__ import annotations

import numpy as np
import pytest

import visint.io
from visint.errors import InputError


@pytest.fixture(scope="module")
def calibration(rigs, tmp_path_factory):
    path = tmp_path_factory.mktemp("rig") / "stereo.yml"
    path.write_text(rigs.opencv_yaml(rigs.ENTRIES, unit="mm"))
    return visint.io.read_calibration(path, (rigs.ROWS, rigs.COLUMNS))


def expected(rigs, calibration, side):
    """(intensity, depth) of the wall, seen by the rectified camera of one side without any image."""
    turn = np.eye(3) if side == 0 else rigs.R
    centre = np.zeros(3) if side == 0 else -rigs.R.T @ rigs.T
    view = calibration.views[side]
    return rigs.seen(view.projection, np.zeros(5), view.rotation @ turn, centre)


@pytest.mark.parametrize("side", [0, 1])
def test_the_rectified_image_is_what_that_camera_sees(rigs, calibration, side):
    """Within 1 % of the range of intensities everywhere: no pixel is displaced or empty."""
    image = rigs.taken()[side]
    found = calibration.rectify(image, side)
    wanted, _ = expected(rigs, calibration, side)
    assert np.isfinite(found).all()
    assert np.abs(found - wanted)[2:-2, 2:-2].max() < 0.01 * np.ptp(image)
    assert not found.flags.writeable


def test_corresponding_points_lie_in_one_row(rigs, calibration):
    """A point of the wall at depth Z is f B / Z further left in the right image, in the same row."""
    camera = calibration.camera
    left, depth = expected(rigs, calibration, 0)
    right = calibration.rectify(rigs.taken()[1], 1)
    rows, columns = np.mgrid[4:92:3, 40:120:3]
    x = columns - camera.focal_length * camera.baseline / depth[rows, columns]
    base = np.floor(x).astype(int)
    part = x - base
    inside = (base >= 2) & (base < 124)
    between = right[rows, base.clip(0, 126)] * (1 - part) + right[rows, base.clip(0, 126) + 1] * part
    assert inside.mean() > 0.5
    assert np.abs(between - left[rows, columns])[inside].max() < 0.02


def test_colour_is_warped_alike(rigs, calibration):
    """Channel by channel."""
    image = rigs.taken()[0]
    color = np.dstack([image, 1 - image, image / 2]).astype(np.float32)
    found = calibration.rectify(color, 0)
    np.testing.assert_allclose(found[..., 0], calibration.rectify(image, 0), atol=0.01)
    assert found.shape == color.shape


def test_intensities_keep_their_range(calibration, rigs):
    """Bicubic interpolation would overshoot beside an edge."""
    image = np.zeros((rigs.ROWS, rigs.COLUMNS), np.float32)
    image[:, 60:] = 1
    found = calibration.rectify(image, 0)
    assert (found.min(), found.max()) == (0, 1)


def test_an_image_of_another_size_is_refused(calibration):
    """Both sizes are named."""
    with pytest.raises(InputError, match="calibrated at 128 × 96 pixels, the image is of 10 × 9"):
        calibration.rectify(np.zeros((9, 10), np.float32), 0)
