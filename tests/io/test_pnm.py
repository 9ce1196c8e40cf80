"""PGM and PPM, plain and raw: maxval is what means 1."""

from __future__ import annotations

import numpy as np
import pytest

import visint.io
from visint.errors import InputError


@pytest.mark.parametrize("top", [1, 15, 255, 256, 1023, 65535])
@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("plain", [False, True])
@pytest.mark.parametrize("size", [(1, 1), (1, 6), (6, 1), (4, 5)], ids=str)
def test_samples_come_back_exactly(put, rng, top, channels, plain, size):
    """Raw and plain, grey and colour, every depth; 16-bit samples are big-endian."""
    samples = rng.integers(0, top + 1, (*size, channels))
    mark = {(1, True): "P2", (3, True): "P3", (1, False): "P5", (3, False): "P6"}[channels, plain]
    header = f"{mark}\n# a comment\n{size[1]} {size[0]}\n{top}\n".encode()
    dtype = ">u2" if top > 255 else "u1"
    body = " ".join(map(str, samples.ravel())).encode() if plain else samples.astype(dtype).tobytes()
    raster = visint.io.read_raster(put(header + body))
    assert raster.top == top
    assert raster.samples.dtype == (np.uint16 if top > 255 else np.uint8)
    np.testing.assert_array_equal(raster.samples, samples[..., 0] if channels == 1 else samples)


def test_raw_samples_may_begin_with_white_space(put):
    """Only one white space ends the header; the next byte is a sample even if it is a line feed."""
    assert visint.io.read_raster(put(b"P5 2 1 255\n\n ")).samples.tolist() == [[10, 32]]


def test_ten_bits_in_sixteen_are_scaled_by_maxval(put):
    """A PGM of maxval 1023 reaches 1 at 1023, and is linear for it has more than 8 bits."""
    data = b"P5 2 1 1023\n" + np.array([1023, 512], ">u2").tobytes()
    np.testing.assert_allclose(visint.io.read_image(put(data)), [[1, 512 / 1023]], rtol=1e-6)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"P5", "damaged PGM/PPM header"),
        (b"P5 4", "damaged PGM/PPM header"),
        (b"P5 4 4 255", "damaged PGM/PPM header"),
        (b"P5 -4 4 255\n" + bytes(16), "damaged PGM/PPM header"),
        (b"P5 4 4 0\n" + bytes(16), "maxval 0"),
        (b"P5 4 4 70000\n" + bytes(99), "maxval 70000"),
        (b"P5 0 4 255\n", "at least 1 × 1"),
        (b"P5 4 4 255\n" + bytes(15), "cut off: it holds 15 bytes"),
        (b"P6 4 4 255\n" + bytes(47), "cut off"),
        (b"P5 4 4 65535\n" + bytes(31), "cut off"),
        (b"P5 2 1 15\n\x10\x00", "above its maxval 15"),
        (b"P2 2 2 255\n1 2 3", "cut off"),
        (b"P2 2 2 255\n1 2 3 4444", "above its maxval"),
        (b"P2 2 2 255\n1 2 3 x", "whole numbers"),
        (b"P2 2 2 255\n1 2 -3 4", "whole numbers"),
        (b"P2 2 2 255\n1 2 3 99999999999999999999", "whole numbers"),
        (b"P2 9 9 255\n" + b"1 " * 41, "cut off"),
        (b"P2 8000 8000 255\n1 2 3", "cut off: it cannot hold"),
        (b"P5 99999 99999 255\n", "VI303"),
        (b"P1 2 2\n1 0 0 1", "a PBM file"),
        (b"P4 8 1\n\xff", "a PBM file"),
        (b"P7\nWIDTH 1\n", "a PAM file"),
    ],
)
def test_broken_files_are_refused_in_words(put, data, words):
    """One line says what is wrong."""
    with pytest.raises(InputError, match=words):
        visint.io.read_raster(put(data))
