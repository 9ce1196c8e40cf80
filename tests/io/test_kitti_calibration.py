"""KITTI's calibrations, by the development kit's definitions."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import visint.io
from visint.errors import InputError

# The form of the 2012 and 2015 sets: P_i = K [I | t_i], in the frame of camera 0.
PAIR = """P0: 7.215377e+02 0 6.095593e+02 0 0 7.215377e+02 1.728540e+02 0 0 0 1 0
P1: 7.215377e+02 0 6.095593e+02 -3.875744e+02 0 7.215377e+02 1.728540e+02 0 0 0 1 0
P2: 7.215377e+02 0 6.095593e+02 4.485728e+01 0 7.215377e+02 1.728540e+02 2.163791e-01 0 0 1 2.745884e-03
P3: 7.215377e+02 0 6.095593e+02 -3.395242e+02 0 7.215377e+02 1.728540e+02 2.199936e+00 0 0 1 2.729905e-03
R0_rect: 1 0 0 0 1 0 0 0 1
Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0
"""


def rig_text(rigs, **changed):
    """``calib_cam_to_cam.txt`` of the known rig as cameras 2 and 3, rectified to another size by OpenCV."""
    size = (rigs.COLUMNS, rigs.ROWS)
    new = (rigs.COLUMNS - 8, rigs.ROWS - 10)
    r1, r2, p1, p2, *_ = cv2.stereoRectify(
        rigs.K1, rigs.D1, rigs.K2, rigs.D2, size, rigs.R, rigs.T[:, None] / 1000, alpha=0, newImageSize=new
    )
    parts = {"calib_time": "09-Jan-2012 13:57:47", "corner_dist": "9.950000e-02"}
    rig = ((2, rigs.K1, rigs.D1, r1, p1), (3, rigs.K2, rigs.D2, r2, p2))
    for camera, matrix, distortion, rotation, projection in rig:
        values = {
            "S": size,
            "K": matrix,
            "D": distortion,
            "S_rect": new,
            "R_rect": rotation,
            "P_rect": projection,
        }
        for what, value in values.items():
            parts[f"{what}_0{camera}"] = " ".join(f"{one:.17e}" for one in np.asarray(value, float).ravel())
    parts.update(changed)
    text = "".join(f"{key}: {value}\n" for key, value in parts.items() if value is not None)
    return text, (rigs.ROWS, rigs.COLUMNS), new[::-1], ((r1, p1), (r2, p2))


def test_the_pair_of_a_rectified_set(put):
    """Cameras 2 and 3: B = (44.85728 + 339.5242) / 721.5377 m; and it is said which pair was taken."""
    found = visint.io.read_calibration(put(PAIR), (375, 1242))
    camera = found.camera
    assert (camera.focal_length, camera.cx, camera.cy) == (721.5377, 609.5593, 172.854)
    assert camera.baseline == pytest.approx((44.85728 + 339.5242) / 721.5377, rel=1e-12)
    assert (camera.doffs, camera.unit, camera.size) == (0, "m", (375, 1242))
    assert found.views is None
    assert "2 and 3" in found.remarks[0]


def test_the_grey_pair_where_it_stands_alone(put):
    """Cameras 0 and 1, and nothing to say."""
    grey = "".join(line for line in PAIR.splitlines(keepends=True) if line[:2] not in ("P2", "P3"))
    found = visint.io.read_calibration(put(grey), (375, 1242))
    assert found.camera.baseline == pytest.approx(387.5744 / 721.5377, rel=1e-12)
    assert found.remarks == ()


def test_a_pair_without_a_size_wants_the_images(put):
    """The file does not say it."""
    with pytest.raises(InputError, match="does not say the size"):
        visint.io.read_calibration(put(PAIR))


def test_a_rig_knows_both_sizes(rigs, put):
    """Images of the rectified size are left alone, those as taken are warped by KITTI's own R and P."""
    text, taken, rectified, turns = rig_text(rigs)
    for size in (rectified, None):
        found = visint.io.read_calibration(put(text), size)
        assert found.views is None
        assert found.camera.size == rectified
    found = visint.io.read_calibration(put(text), taken)
    assert found.camera.size == rectified
    assert found.camera.focal_length == turns[0][1][0, 0]
    assert found.camera.baseline == pytest.approx(np.linalg.norm(rigs.T) / 1000, rel=1e-12)
    for view, (rotation, projection) in zip(found.views, turns, strict=True):
        np.testing.assert_array_equal(view.rotation, rotation)
        np.testing.assert_array_equal(view.projection, projection[:, :3])
    assert "were rectified" in found.remarks[0]


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"P_rect_03": None}, "P_rect_00: and P_rect_01 are missing"),
        ({"P_rect_02": "1 2 3"}, "P_rect_02: wants 12 numbers"),
        ({"P_rect_02": "nan " * 12}, "P_rect_02: wants 12 numbers"),
        ({"P_rect_03": "0 " * 12}, "P_rect_03: wants"),
        ({"S_rect_02": "0 0"}, "S_rect_02: wants width and height"),
        ({"S_02": None}, "S_02: is missing"),
        ({"K_03": "1 " * 8}, "K_03: wants 9 numbers"),
        ({"D_02": None}, "D_02: is missing"),
    ],
)
def test_each_mistake_is_named_with_its_line(rigs, put, changed, words):
    """What is missing or of the wrong length."""
    text, taken, *_ = rig_text(rigs, **changed)
    with pytest.raises(InputError, match=f"VI306.*{words}"):
        visint.io.read_calibration(put(text), taken)
