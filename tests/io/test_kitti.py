"""KITTI disparity: 16 bits, 256 steps a pixel, 0 unknown."""

from __future__ import annotations

import numpy as np
import pytest

import visint.io
from visint.errors import InputError, OutputError


def test_file_holds_disparity_times_256(make):
    """By an independent decoder: rounded to the nearest step, unknown 0, a known 0 one step."""
    disparity = np.array([[1, 2.5, np.nan, np.inf], [0, 1 / 512 + 1e-6, 255.99609375, 100.001]], np.float32)
    steps, depth, colour = make.unpng(visint.io.encode_kitti(disparity))
    assert (depth, colour) == (16, 0)
    assert steps.tolist() == [[256, 640, 0, 0], [1, 1, 65535, 25600]]


def test_every_step_reads_back_exactly(put):
    """All 65536 values; 0 is NaN."""
    steps = np.arange(65536, dtype=np.uint16).reshape(256, 256)
    read = visint.io.read(put(visint.io.encode_png(steps)), "Disparity")
    assert np.isnan(read[0, 0])
    np.testing.assert_array_equal(read.ravel()[1:] * 256, steps.ravel()[1:])
    np.testing.assert_array_equal(visint.io.encode_kitti(read), visint.io.encode_png(steps))


@pytest.mark.parametrize("value", [-0.01, -5, 256, 1e6])
def test_disparities_beyond_the_format_are_refused(value):
    """Converging rigs have negative ones; they would be lost without a word."""
    disparity = np.array([[1, value]], np.float32)
    assert not visint.io.fits_kitti(disparity)
    with pytest.raises(OutputError, match=r"VI603.*outside 0"):
        visint.io.encode_kitti(disparity)


def test_a_map_without_a_known_pixel_fits():
    """All unknown is all 0."""
    assert visint.io.fits_kitti(np.full((2, 2), np.nan, np.float32))
    assert visint.io.encode_kitti(np.full((2, 2), np.nan, np.float32))


@pytest.mark.parametrize("array", [np.zeros((2, 2)), np.zeros((2, 2, 3), np.float32)], ids=str)
def test_other_arrays_are_refused(array):
    """float32 (H, W) alone."""
    with pytest.raises(OutputError, match="VI603"):
        visint.io.encode_kitti(array)


@pytest.mark.parametrize(
    ("samples", "colour", "depth", "words"),
    [
        (np.zeros((2, 2), np.uint8), 0, 8, "is an 8-bit image; a Disparity wants 16-bit grey PNG"),
        (np.zeros((2, 2, 3), np.uint8), 2, 8, "is an 8-bit image"),
        (np.zeros((2, 2, 3), np.uint16), 2, 16, "is a 16-bit colour image"),
    ],
)
def test_other_images_are_no_disparity(make, put, samples, colour, depth, words):
    """The factor of an 8-bit disparity map stands in no file."""
    with pytest.raises(InputError, match=words):
        visint.io.read(put(make.png(samples, colour, depth)), "Disparity")
