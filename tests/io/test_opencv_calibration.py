"""OpenCV's stereo YAML: the same numbers as cv::FileStorage, and nothing that it would end the process on."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import visint.io
from visint.errors import InputError
from visint.io.opencv_yaml import opencv_entries

PAIR = {
    "P1": np.array([[700.5, 0, 320.25, 0], [0, 700.5, 240.75, 0], [0, 0, 1, 0]]),
    "P2": np.array([[700.5, 0, 300.25, -84060.0], [0, 700.5, 240.75, 0], [0, 0, 1, 0]]),
}


def test_matrices_agree_with_filestorage_to_the_last_bit(rigs, tmp_path, rng):
    """Written and read by cv::FileStorage, read by us."""
    path = str(tmp_path / "stereo.yml")
    matrices = {"M1": rigs.K1, "D1": rigs.D1, "any": rng.normal(size=(5, 7)) * 1e-9, "T": rigs.T * 1e12}
    writer = cv2.FileStorage(path, cv2.FILE_STORAGE_WRITE)
    for name, matrix in matrices.items():
        writer.write(name, matrix)
    writer.write("image_width", 1280)
    writer.write("about", "two words: and more")
    writer.release()
    ours = opencv_entries((tmp_path / "stereo.yml").read_text(), "stereo.yml")
    theirs = cv2.FileStorage(path, cv2.FILE_STORAGE_READ)
    for name in matrices:
        wanted = theirs.getNode(name).mat()
        np.testing.assert_array_equal(ours[name].value.reshape(wanted.shape), wanted)
    assert ours["image_width"].value == theirs.getNode("image_width").real()
    assert ours["about"].value == theirs.getNode("about").string()


def test_a_rig_becomes_the_camera_of_opencvs_stereorectify(rigs, put):
    """Its own definition, number by number; the size from the file."""
    text = rigs.opencv_yaml(rigs.ENTRIES, image_width=rigs.COLUMNS, image_height=rigs.ROWS, unit="mm")
    found = visint.io.read_calibration(put(text))
    size = (rigs.COLUMNS, rigs.ROWS)
    r1, r2, p1, p2, *_ = cv2.stereoRectify(
        rigs.K1,
        rigs.D1,
        rigs.K2,
        rigs.D2,
        size,
        rigs.R,
        rigs.T[:, None],
        flags=cv2.CALIB_ZERO_DISPARITY,
        alpha=0,
    )
    camera = found.camera
    assert (camera.focal_length, camera.cx, camera.cy) == (p1[0, 0], p1[0, 2], p1[1, 2])
    assert camera.baseline == pytest.approx(np.linalg.norm(rigs.T), rel=1e-12)
    assert (camera.doffs, camera.size, camera.unit) == (0, (rigs.ROWS, rigs.COLUMNS), "mm")
    for view, rotation, projection in zip(found.views, (r1, r2), (p1, p2), strict=True):
        np.testing.assert_array_equal(view.rotation, rotation)
        np.testing.assert_array_equal(view.projection, projection[:, :3])
    assert "was rectified" in found.remarks[0] or "were rectified" in found.remarks[0]


def test_the_camera_alone_is_refused_for_a_rig(rigs, put):
    """Who takes it without warping the images would measure nonsense."""
    with pytest.raises(InputError, match=r"not rectified[\s\S]*read_calibration\(path, size\)\.rectify"):
        visint.io.read_camera(put(rigs.opencv_yaml(rigs.ENTRIES)), (rigs.ROWS, rigs.COLUMNS))


def test_projections_alone_are_a_rectified_pair(rigs, put):
    """f, principal points, B = 84060 / 700.5 = 120."""
    found = visint.io.read_calibration(put(rigs.opencv_yaml(PAIR)), (480, 640))
    assert found.views is None
    camera = found.camera
    assert (camera.focal_length, camera.cx, camera.cy, camera.doffs) == (700.5, 320.25, 240.75, -20)
    assert camera.baseline == pytest.approx(120, rel=1e-15)
    assert (camera.size, camera.unit) == ((480, 640), "units of T")


def test_a_rig_that_is_rectified_already_is_left_alone(rigs, put):
    """No turn, no distortion, equal focal lengths: no pixel is touched."""
    entries = {"K1": rigs.K1, "K2": rigs.K1 + np.outer([4, 0, 0], [0, 0, 1]), "R": np.eye(3),
               "T": np.array([-60.0, 0, 0])}  # fmt: skip
    entries["K1"] = entries["K1"].copy()
    for key in ("K1", "K2"):
        entries[key][1, 1] = 150
    found = visint.io.read_calibration(put(rigs.opencv_yaml(entries)), (9, 9))
    assert found.views is None
    assert (found.camera.baseline, found.camera.doffs, found.remarks) == (60, 4, ())
    image = np.ones((9, 9), np.float32)
    assert found.rectify(image, 0) is image


@pytest.mark.parametrize(
    "names",
    [
        {"M1": "cameraMatrix1", "M2": "cameraMatrix2", "D1": "distCoeffs1", "D2": "distCoeffs2"},
        {"M1": "camera_matrix_left", "M2": "camera_matrix_right", "D1": "D_L", "D2": "D_R"},
        {"M1": "K1", "M2": "K2", "R": "rotation", "T": "translation"},
    ],
)
def test_the_names_that_people_give(rigs, put, names):
    """The same camera."""
    wanted = visint.io.read_calibration(put(rigs.opencv_yaml(rigs.ENTRIES)), (96, 128)).camera
    try:
        text = rigs.opencv_yaml({names.get(key, key): value for key, value in rigs.ENTRIES.items()})
        assert visint.io.read_calibration(put(text), (96, 128)).camera == wanted
    except InputError as error:
        raise AssertionError(str(error)) from error


def test_intrinsics_and_extrinsics_may_be_put_one_after_the_other(rigs, put):
    """As OpenCV's sample writes two files; ``cat`` makes one of them."""
    inner = {key: rigs.ENTRIES[key] for key in ("M1", "D1", "M2", "D2")}
    outer = {key: rigs.ENTRIES[key] for key in ("R", "T")}
    both = rigs.opencv_yaml(inner) + rigs.opencv_yaml(outer)
    one = visint.io.read_calibration(put(rigs.opencv_yaml(rigs.ENTRIES)), (96, 128)).camera
    assert visint.io.read_calibration(put(both), (96, 128)).camera == one
    with pytest.raises(InputError, match=r"R: is missing[\s\S]*T: is missing"):
        visint.io.read_calibration(put(rigs.opencv_yaml(inner)), (96, 128))


WRONG = {
    "no size": ({}, None, "image_width: and image_height are missing"),
    "matrix": ({"M1": np.eye(4)}, (9, 9), "M1: wants a matrix of 3 × 3"),
    "focal": ({"M2": np.diag([-5.0, 5, 1])}, (9, 9), "M2: wants the form"),
    "coefficients": ({"D1": np.zeros(7)}, (9, 9), "D1: wants 4, 5, 8, 12 or 14"),
    "turn": ({"R": 2 * np.eye(3)}, (9, 9), "R: is no rotation"),
    "mirror": ({"R": np.diag([1.0, 1, -1])}, (9, 9), "R: is no rotation"),
    "no baseline": ({"T": np.zeros(3)}, (9, 9), "T: wants three numbers"),
    "swapped": ({"T": np.array([60.0, 0, 0]), "R": np.eye(3)}, (9, 9), "second camera left of the first"),
    "above": ({"T": np.array([0, 60.0, 0]), "R": np.eye(3)}, (9, 9), "above or behind"),
    "apart": ({"R": cv2.Rodrigues(np.array([0, 3.0, 0]))[0]}, (96, 128), "left of|common|side by side"),
}


@pytest.mark.parametrize("case", WRONG)
def test_each_mistake_is_named(rigs, put, case):
    """With its key and line."""
    changes, size, words = WRONG[case]
    with pytest.raises(InputError, match=words) as caught:
        visint.io.read_calibration(put(rigs.opencv_yaml({**rigs.ENTRIES, **changes})), size)
    assert {problem.code for problem in caught.value.problems} == {"VI306"}


def test_all_mistakes_are_told_together(rigs, put):
    """Three wrong parts, three lines."""
    entries = {**rigs.ENTRIES, "M1": np.eye(2), "D2": np.zeros(3), "R": np.zeros((3, 3))}
    with pytest.raises(InputError) as caught:
        visint.io.read_calibration(put(rigs.opencv_yaml(entries)), (9, 9))
    assert [problem.where.path for problem in caught.value.problems] == ["M1", "D2", "R"]
    assert all(problem.where.line > 1 for problem in caught.value.problems)
