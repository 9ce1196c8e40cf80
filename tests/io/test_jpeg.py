"""JPEG files are read whole or refused."""

from __future__ import annotations

import numpy as np
import pytest

import visint.io
from visint.errors import InputError

PROGRESSIVE = (2, 1)  # cv2.IMWRITE_JPEG_PROGRESSIVE
RESTARTS = (4, 2)  # cv2.IMWRITE_JPEG_RST_INTERVAL


@pytest.fixture
def photo(rng):
    return rng.integers(0, 256, (40, 56, 3), dtype=np.uint8)


def segment(marker, body):
    return bytes([0xFF, marker]) + (len(body) + 2).to_bytes(2, "big") + body


@pytest.mark.parametrize("flags", [(), PROGRESSIVE, RESTARTS], ids=["baseline", "progressive", "restarts"])
def test_colours_arrive_red_first(make, put, flags):
    """A plain red JPEG is red, in every coding."""
    blue_green_red = np.zeros((20, 30, 3), np.uint8)
    blue_green_red[..., 2] = 200
    raster = visint.io.read_raster(put(make.jpeg(blue_green_red, *flags)))
    assert raster.samples.shape == (20, 30, 3)
    assert abs(int(raster.samples[10, 10, 0]) - 200) < 4
    assert raster.samples[10, 10, 1:].max() < 4


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (8, 8), (17, 3)], ids=str)
def test_grey_and_odd_sizes(make, put, size):
    """A grey JPEG of any size has one channel of that size."""
    raster = visint.io.read_raster(put(make.jpeg(np.full(size, 90, np.uint8))))
    assert raster.samples.shape == size
    assert abs(raster.samples.astype(int) - 90).max() <= 2


@pytest.mark.parametrize("flags", [(), PROGRESSIVE, RESTARTS], ids=["baseline", "progressive", "restarts"])
@pytest.mark.parametrize("part", [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0])
def test_truncated_jpeg_is_refused(make, put, photo, flags, part):
    """Where OpenCV returns a full-size array half grey, visint refuses the file."""
    data = make.jpeg(photo, *flags)
    cut = data[: min(int(len(data) * part), len(data) - 1)]
    with pytest.raises(InputError, match=r"VI302 .*cut\.jpg: is a .*JPEG"):
        visint.io.read_raster(put(cut, "cut.jpg"))


def test_end_mark_of_a_thumbnail_does_not_count(make, put, photo):
    """A thumbnail in the header has an end mark of its own; the image must still have one."""
    data, thumbnail = make.jpeg(photo), make.jpeg(photo[:8, :8])
    whole = data[:2] + segment(0xE1, b"Exif\0\0" + thumbnail) + data[2:]
    assert visint.io.read_raster(put(whole)).samples.shape == photo.shape
    with pytest.raises(InputError, match="end mark"):
        visint.io.read_raster(put(whole[: len(whole) // 2 + len(thumbnail) // 2]))


def test_bytes_after_the_end_mark_are_left_alone(make, put, photo):
    """Cameras append previews and padding."""
    data = make.jpeg(photo)
    a, b = (visint.io.read_raster(put(one)).samples for one in (data, data + b"\0" * 100))
    np.testing.assert_array_equal(a, b)


def test_orientation_tag_does_not_turn_the_image(make, put, photo):
    """Pixels are taken as stored: a calibration knows them so."""
    data = make.jpeg(photo)
    tag = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"
    turned = visint.io.read_raster(put(data[:2] + segment(0xE1, tag) + data[2:]))
    assert turned.samples.shape == photo.shape


def frame_of(data):
    """Where the frame header's marker stands."""
    return next(at for at in range(len(data)) if data[at : at + 2] in (b"\xff\xc0", b"\xff\xc2"))


def changed(data, offset, value):
    at = frame_of(data) + offset
    return data[:at] + value + data[at + len(value) :]


def test_size_is_checked_before_decoding(make, put, photo):
    """A header that claims 60000 × 60000 is refused by its claim, one of 8000 × 8000 by its few bytes."""
    data = make.jpeg(photo)
    huge = (60000).to_bytes(2, "big") * 2
    with pytest.raises(InputError, match=r"too few bytes|VI303"):
        visint.io.read_raster(put(changed(data, 5, huge)))
    with pytest.raises(InputError, match="too few bytes for the 8000 × 8000"):
        visint.io.read_raster(put(changed(data, 5, (8000).to_bytes(2, "big") * 2)))
    padded = changed(data, 5, huge)
    filled = padded[:-2] + bytes(8_000_000) + padded[-2:]
    with pytest.raises(InputError, match=r"VI303 .*60000 × 60000"):
        visint.io.read_raster(put(filled))


@pytest.mark.parametrize(
    ("offset", "value", "words"),
    [
        (1, b"\xc3", "lossless"),
        (1, b"\xc9", "arithmetic"),
        (4, b"\x0c", "12-bit"),
        (9, b"\x04", "CMYK"),
        (9, b"\x02", "channels"),
        (5, b"\0\0", "at least 1 × 1|without an image|damaged"),
    ],
)
def test_sorts_of_jpeg_that_are_not_read_are_named(make, put, photo, offset, value, words):
    """Lossless, arithmetic, 12 bit and CMYK are refused in words, not decoded to something else."""
    with pytest.raises(InputError, match=words):
        visint.io.read_raster(put(changed(make.jpeg(photo), offset, value)))


def test_endless_scans_are_refused(make, put, photo):
    """Each scan of a progressive JPEG costs a pass over the image; thousands of them are an attack."""
    data = make.jpeg(photo, *PROGRESSIVE)
    scan = segment(0xDA, b"\x01\x01\x00\x00\x00\x00") + b"\x00"
    with pytest.raises(InputError, match="scans"):
        visint.io.read_raster(put(data[:-2] + scan * 500 + data[-2:]))


def test_jpeg_without_an_image_is_refused(put):
    """Start and end mark alone."""
    with pytest.raises(InputError, match="without an image"):
        visint.io.read_raster(put(b"\xff\xd8\xff\xd9"))
