"""PFM: bottom row first, either byte order, unknown infinite; the scale is no factor."""

from __future__ import annotations

import struct

import numpy as np
import pytest

import visint.io
from visint.errors import InputError, OutputError

SIZES = [(1, 1), (1, 5), (5, 1), (3, 4)]


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("little", [True, False])
def test_values_arrive_top_row_first(make, put, rng, size, little):
    """Float by float as they were packed."""
    values = rng.normal(size=size).astype(np.float32)
    read = visint.io.read(put(make.pfm(values, little)), "Depth")
    np.testing.assert_array_equal(read, values)
    assert read.dtype == np.float32
    assert read.flags.c_contiguous
    assert not read.flags.writeable


@pytest.mark.parametrize("scale", [0.003922, 1.0, 255.0])
def test_scale_is_not_multiplied_in(make, put, scale):
    """Middlebury writes 0.003922 there; OpenCV divides by it and finds disparities of 16,000 pixels."""
    values = np.array([[63.0, 1.5]], np.float32)
    np.testing.assert_array_equal(visint.io.read(put(make.pfm(values, scale=scale)), "Disparity"), values)


def test_infinite_is_unknown_both_ways(make, put):
    """Infinite reads as NaN; NaN is written as infinite."""
    values = np.array([[1, np.inf, -np.inf, np.nan]], np.float32)
    read = visint.io.read(put(make.pfm(values)), "Depth")
    np.testing.assert_array_equal(read, [[1, np.nan, np.nan, np.nan]])
    np.testing.assert_array_equal(make.unpfm(visint.io.encode_pfm(read)), [[1, np.inf, np.inf, np.inf]])


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_what_is_written_is_what_an_independent_reader_reads(make, put, rng, size):
    """Grey by an own reader of the test, colour by a round trip; bit for bit."""
    grey = rng.normal(size=size).astype(np.float32)
    np.testing.assert_array_equal(make.unpfm(visint.io.encode_pfm(grey)), grey)
    color = rng.random((*size, 3)).astype(np.float32)
    data = visint.io.encode_pfm(color)
    assert data.startswith(b"PF\n")
    np.testing.assert_array_equal(visint.io.read_color(put(data)), color)
    np.testing.assert_array_equal(visint.io.read_color(put(make.pfm(color))), color)


@pytest.mark.parametrize("head", [b"Pf 2 1 -1.0\n", b"Pf\r\n2 1\r\n-1\r\n", b"Pf\n2\n1\n-1e0\n"])
def test_headers_as_other_programs_write_them(put, head):
    """One line or four, with or without carriage returns."""
    read = visint.io.read(put(head + struct.pack("<2f", 7, 8)), "Depth")
    assert read.tolist() == [[7, 8]]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"Pf", "damaged PFM header"),
        (b"Pf\n", "damaged PFM header"),
        (b"Pf\n2 2\n", "damaged PFM header"),
        (b"Pf\n2 x\n-1\n", "damaged PFM header"),
        (b"Pf\n2 2\n0\n" + bytes(16), "scale other than 0"),
        (b"Pf\n2 2\nnan\n" + bytes(16), "damaged PFM header"),
        (b"Pf\n2 2\n...\n" + bytes(16), "damaged PFM header"),
        (b"Pf\n2 2\n1e999\n" + bytes(16), "damaged PFM header"),
        (b"Pf\n0 2\n-1\n", "at least 1 × 1"),
        (b"Pf\n2 2\n-1\n" + bytes(15), "holds 15 bytes of values where its PFM header claims 16"),
        (b"Pf\n2 2\n-1\n" + bytes(17), "holds 17 bytes"),
        (b"PF\n2 2\n-1\n" + bytes(16), "claims 48"),
        (b"Pf\n60000 60000\n-1\n", "VI303 .*60000 × 60000"),
        (b"PF\n8000 8000\n-1\n", "VI303 .*MB"),
    ],
)
def test_broken_files_are_refused_in_words(put, data, words):
    """Cut off, too long, or with a header that says nothing."""
    with pytest.raises(InputError, match=words):
        visint.io.read(put(data), "Depth")


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((2, 2)),
        np.zeros((2, 2), np.int32),
        np.zeros((2, 2, 2), np.float32),
        np.zeros(4, np.float32),
        np.zeros((0, 3), np.float32),
    ],
    ids=lambda a: f"{a.dtype}{a.shape}",
)
def test_arrays_without_an_exact_pfm_are_refused(array):
    """PFM holds float32 of one or three channels and nothing else."""
    with pytest.raises(OutputError, match=r"VI603.*wants float32"):
        visint.io.encode_pfm(array)
