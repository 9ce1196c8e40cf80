"""Real pairs: what visint reads is what independent readers of the test find in the file."""

from __future__ import annotations

import re

import cv2
import numpy as np
import pytest

import visint.io
from visint.errors import InputError

QUARTER = ["Adirondack", "ArtL", "Motorcycle", "Piano", "PianoL", "Pipes", "Playtable"]


def test_piano_truth_is_in_pixels(real_data, make):
    """Float by float; about 63 pixels at most, not the 16,075 that OpenCV makes of it."""
    path = real_data / "mb2014q" / "Piano" / "disp_left.pfm"
    wanted = make.unpfm(path.read_bytes())
    read = visint.io.read(path, "Disparity")
    np.testing.assert_array_equal(read, np.where(np.isinf(wanted), np.nan, wanted))
    assert 40 < np.nanmax(read) < 64
    assert np.isnan(read).any()
    np.testing.assert_array_equal(make.unpfm(visint.io.encode_pfm(read)), wanted)


@pytest.mark.parametrize("scene", QUARTER)
def test_calibration_fits_its_pair(real_data, scene):
    """f, doffs and bounds as the file's own digits say; the truth lies within the search range."""
    folder = real_data / "mb2014q" / scene
    text = (folder / "calib.txt").read_text()
    camera = visint.io.read(folder / "calib.txt", "Camera")
    said = {key: float(value) for key, value in re.findall(r"(\w+)\s*=\s*([-\d.]+)", text)}
    assert (camera.baseline, camera.doffs) == (said["baseline"], said["doffs"])
    assert camera.disparity_range == (said["vmin"], said["vmax"])
    assert f"cam0=[ {camera.focal_length} 0".replace(".0 ", " ") in text
    left = visint.io.read_color(folder / "left.png")
    assert left.shape == (*camera.size, 3)
    truth = visint.io.read(folder / "disp_left.pfm", "Disparity")
    assert truth.shape == camera.size
    assert np.nanmin(truth) >= said["vmin"] - 1
    assert np.nanmax(truth) <= said["vmax"] + 1


def test_every_raster_file_is_read(real_data):
    """All PNG, JPEG and PGM files of the collection, at the size that their headers give."""
    count = 0
    for path in sorted(real_data.rglob("*")):
        if path.suffix in (".png", ".jpg", ".pgm", ".ppm") and path.stat().st_size < 300_000:
            raster = visint.io.read_raster(path)
            assert raster.samples.max() <= raster.top
            count += 1
    assert count > 20


def test_a_real_image_against_the_tests_own_decoder(real_data, make):
    """An RGB photograph with every row filter, sample by sample."""
    path = real_data / "mb2006" / "Plastic" / "left.png"
    samples, _, _ = make.unpng(path.read_bytes())
    np.testing.assert_array_equal(visint.io.read_raster(path).samples, samples)


def test_eight_bit_truth_is_refused_as_disparity(real_data):
    """Its factor (3 for third-size pairs) stands nowhere in it."""
    with pytest.raises(InputError, match="8-bit"):
        visint.io.read(real_data / "mb2006" / "Plastic" / "disp_left.png", "Disparity")


def test_a_real_tiff_against_opencv(real_data):
    """A scanned texture: the same samples."""
    path = next((real_data / "extra" / "texture_brodatz").glob("*.tiff"))
    wanted = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(visint.io.read_raster(path).samples, wanted)


def test_real_formats_that_are_not_read_are_named(real_data):
    """MATLAB files are refused by name."""
    with pytest.raises(InputError, match="is a MATLAB file"):
        visint.io.read(real_data / "extra" / "mozart_range" / "mozart.mat", "Depth")
