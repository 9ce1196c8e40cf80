"""Calibrations of every format on the command line: an unrectified rig is rectified, and that is said."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import cv2
import numpy as np
import pytest


def _rigs():
    path = Path(__file__).parents[1] / "io" / "rigs.py"
    spec = importlib.util.spec_from_file_location("rigs", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


RIGS = _rigs()


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """Both images of a wall as the rig takes them, 16 bits, and its calibration."""
    folder = tmp_path_factory.mktemp("rig")
    for name, image in zip(("left", "right"), RIGS.taken(), strict=True):
        cv2.imwrite(str(folder / f"{name}.tif"), np.rint(image * 65535).astype(np.uint16))
    (folder / "stereo.yml").write_text(RIGS.opencv_yaml(RIGS.ENTRIES, unit="mm"))
    return folder


def options(folder):
    return ["--left", folder / "left.tif", "--right", folder / "right.tif", "--calib", folder / "stereo.yml"]


def wall(folder):
    """Depth of the wall in the rectified left camera's frame."""
    from visint import io

    calibration = io.read_calibration(folder / "stereo.yml", (RIGS.ROWS, RIGS.COLUMNS))
    view = calibration.views[0]
    return RIGS.seen(view.projection, np.zeros(5), view.rotation, np.zeros(3))[1]


def test_an_unrectified_rig_is_rectified_and_said_so(visint, rig, tmp_path):
    """Depth is that of the wall, seen by the rectified left camera; a warning says what was done."""
    done = visint("run", "stereo_sgm", *options(rig), "--disparity-range", "2,16", "--out", "out")
    assert done.code == 0, done
    assert "inputs.camera: the calibration is of a pair that is not rectified" in done.err
    depth = cv2.imread(str(tmp_path / "out" / "depth.pfm"), cv2.IMREAD_UNCHANGED)
    sure = cv2.imread(str(tmp_path / "out" / "disparity_confidence.pfm"), cv2.IMREAD_UNCHANGED) > 0.5
    known = np.isfinite(depth) & sure
    assert known.mean() > 0.4
    error = np.abs(depth / wall(rig) - 1)[known]
    assert np.median(error) < 0.02
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert record["inputs"]["camera"]["value"]["unit"] == "mm"
    assert visint("run", "out/run.json", "--out", "again").code == 0
    assert (tmp_path / "again/depth.pfm").read_bytes() == (tmp_path / "out/depth.pfm").read_bytes()


def test_one_image_sees_by_the_left_camera(visint, rig, tmp_path):
    """A graph without a right image: the one it has is rectified."""
    (tmp_path / "one.yaml").write_text(
        "visint: 1\nname: one\ninputs: {image: Image, camera: Camera?}\n"
        "nodes: {it: {uses: texture.moments, in: {image: inputs.image}}}\noutputs: {image: inputs.image}\n"
    )
    done = visint(
        "run", "one.yaml", "--in", f"image={rig / 'left.tif'}", "--calib", rig / "stereo.yml", "--out", "o"
    )
    assert done.code == 0, done
    image = cv2.imread(str(tmp_path / "o" / "image.pfm"), cv2.IMREAD_UNCHANGED)
    assert np.abs(image - RIGS.taken()[0]).max() > 0.05


def test_what_cannot_be_warped_is_refused(refused, rig, tmp_path):
    """A mask of the size of the images would no longer fit them."""
    cv2.imwrite(str(tmp_path / "mask.png"), np.zeros((RIGS.ROWS, RIGS.COLUMNS), np.uint8))
    (tmp_path / "g.yaml").write_text(
        "visint: 1\nname: g\ninputs: {left: Image, mask: Mask, camera: Camera}\n"
        "nodes: {it: {uses: texture.moments, in: {image: inputs.left}}}\noutputs: {mask: inputs.mask}\n"
    )
    inputs = [
        "--left",
        rig / "left.tif",
        "--in",
        f"mask={tmp_path / 'mask.png'}",
        "--calib",
        rig / "stereo.yml",
    ]
    said = refused(3, "run", "g.yaml", *inputs, "--out", "out")
    assert "'mask' cannot be rectified" in said


def test_images_of_another_size_are_refused(refused, rig, tmp_path, pair):
    """The rig was calibrated at another size."""
    text = RIGS.opencv_yaml(RIGS.ENTRIES, image_width=128, image_height=96)
    (tmp_path / "c.yml").write_text(text)
    said = refused(3, "run", "stereo_sgm", *pair.images, "--calib", "c.yml", "--out", "out")
    assert "calibrated at 128 × 96 pixels, the image is of 64 × 48" in said


def test_kitti(visint, pair, tmp_path):
    """P0 and P1: metres, no search range, so one is estimated."""
    focal = "100 0 31.5 {} 0 100 23.5 0 0 0 1 0"
    (tmp_path / "calib.txt").write_text(f"P0: {focal.format(0)}\nP1: {focal.format(-54)}\n")
    assert visint("run", "stereo_sgm", *pair.images, "--calib", "calib.txt", "--out", "out").code == 0
    camera = json.loads((tmp_path / "out/run.json").read_text())["inputs"]["camera"]["value"]
    assert (camera["baseline"], camera["unit"], camera["disparity_range"]) == (0.54, "m", None)
    depth = cv2.imread(str(tmp_path / "out" / "depth.pfm"), cv2.IMREAD_UNCHANGED)
    assert abs(np.median(depth[np.isfinite(depth)]) - 100 * 0.54 / 5) < 0.2
