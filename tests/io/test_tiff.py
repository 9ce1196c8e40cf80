"""TIFF: every sort that is read comes exactly; every other, and every damage, is one line."""

from __future__ import annotations

import struct
import zlib

import cv2
import numpy as np
import pytest

import visint.io
from visint.errors import InputError
from visint.io.limits import Limits

COMPRESSIONS = {"none": 1, "LZW": 5, "Deflate": 8, "old Deflate": 32946, "PackBits": 32773}
DTYPES = {"u1": 255, "u2": 65535, "f4": 1}


def picture(rng, dtype, channels=1, size=(23, 37)):
    """Noise with even stretches, so that packers have runs and repeats to work on."""
    samples = rng.random((*size, channels))
    samples[4:12, 3:30] = 0.25
    samples = samples if dtype == "f4" else np.floor(samples * (DTYPES[dtype] + 1))
    return samples.astype(dtype)[..., 0] if channels == 1 else samples.astype(dtype)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("compression", COMPRESSIONS)
@pytest.mark.parametrize("channels", [1, 3])
def test_what_opencv_writes_is_read_exactly(put, rng, dtype, compression, channels):
    """OpenCV (libtiff) as the writer: each compression, its own choice of predictor."""
    samples = picture(rng, dtype, channels)
    bgr = samples[..., ::-1] if channels == 3 else samples
    done, data = cv2.imencode(".tif", bgr, [cv2.IMWRITE_TIFF_COMPRESSION, COMPRESSIONS[compression]])
    assert done
    path = put(data.tobytes(), "a.tif")
    if dtype == "f4":
        read = visint.io.read(path, "Color" if channels == 3 else "Image")
    else:
        read = visint.io.read_raster(path).samples
    np.testing.assert_array_equal(read, samples)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("shape", [{}, {"rows": 5}, {"rows": 1}, {"tile": (16, 16)}], ids=str)
def test_byte_orders_strips_and_tiles(make, put, rng, dtype, order, shape):
    """From the format's definition: both byte orders, strips of any height, tiles that stick out."""
    samples = picture(rng, dtype, 3)
    path = put(make.tiff(samples, order=order, **shape), "a.tif")
    read = visint.io.read(path, "Color") if dtype == "f4" else visint.io.read_raster(path).samples
    np.testing.assert_array_equal(read, samples)


def test_lzw_through_a_full_table(put, rng):
    """Long enough that the codes grow to 12 bits and the table is emptied on the way."""
    samples = (rng.integers(0, 7, (400, 300)) * 36).astype(np.uint8)
    flags = [cv2.IMWRITE_TIFF_COMPRESSION, 5, cv2.IMWRITE_TIFF_ROWSPERSTRIP, 400, cv2.IMWRITE_TIFF_PREDICTOR, 1]
    done, data = cv2.imencode(".tif", samples, flags)
    assert done
    np.testing.assert_array_equal(visint.io.read_raster(put(data.tobytes())).samples, samples)


def test_prediction_of_whole_numbers(make, put, rng):
    """Predictor 2: each sample less its left neighbour of the same colour, modulo 2ⁿ."""
    samples = picture(rng, "u2", 3)
    differences = samples.copy()
    differences[:, 1:] -= samples[:, :-1]
    data = make.tiff(differences, order=">", pack=zlib.compress, _259=(3, [8]), _317=(3, [2]))
    np.testing.assert_array_equal(visint.io.read_raster(put(data)).samples, samples)


def test_prediction_of_floats(make, put, rng):
    """Predictor 3: the bytes of a row by significance, each less its left neighbour of the same colour."""
    samples = picture(rng, "f4", 3)
    rows, columns, channels = samples.shape
    planes = samples.astype(">f4").view(np.uint8).reshape(rows, columns * channels, 4).transpose(0, 2, 1)
    flat = planes.reshape(rows, -1, channels)
    stored = flat.copy()
    stored[:, 1:] -= flat[:, :-1]
    body = np.ascontiguousarray(stored).reshape(rows, -1).view("<f4").reshape(samples.shape)
    data = make.tiff(body, pack=zlib.compress, _259=(3, [8]), _317=(3, [3]))
    np.testing.assert_array_equal(visint.io.read(put(data), "Color"), samples)


def test_white_is_zero_and_alpha_and_pages(make, put, rng):
    """Inverted grey is turned round; alpha goes with a word; of several pages the first is read, and said."""
    grey = picture(rng, "u1")
    np.testing.assert_array_equal(
        visint.io.read_raster(put(make.tiff(grey, photometric=0))).samples, 255 - grey
    )
    notes = []
    rgba = picture(rng, "u1", 4)
    read = visint.io.read_raster(put(make.tiff(rgba)), note=notes.append)
    np.testing.assert_array_equal(read.samples, rgba[..., :3])
    data = bytearray(make.tiff(grey))
    start = struct.unpack_from("<I", data, 4)[0]
    count = struct.unpack_from("<H", data, start)[0]
    struct.pack_into("<I", data, start + 2 + 12 * count, 8)
    visint.io.read_raster(put(bytes(data)), note=notes.append)
    assert ["alpha channel" in notes[0], "several pages" in notes[1]] == [True, True]


def test_floats_are_maps_and_whole_numbers_are_masks(make, put, rng):
    """A float TIFF is depth, exactly; a whole-numbered one is none, and no disparity by KITTI's rule."""
    depth = picture(rng, "f4") * 1000
    np.testing.assert_array_equal(visint.io.read(put(make.tiff(depth)), "Depth"), depth)
    whole = put(make.tiff(picture(rng, "u2")))
    for kind in ("Depth", "Disparity"):
        with pytest.raises(InputError, match=f"is TIFF; a {kind} is read from"):
            visint.io.read(whole, kind)
    mask = (rng.random((9, 7)) > 0.5).astype(np.uint8) * 255
    np.testing.assert_array_equal(visint.io.read(put(make.tiff(mask)), "Mask"), mask > 0)


REFUSED = {
    "palette": ({"photometric": 3}, "palette"),
    "cmyk": ({"photometric": 5}, "CMYK"),
    "jpeg": ({"_259": (3, [7])}, "compression 7"),
    "fax": ({"_259": (3, [4])}, "compressions read: none, LZW, Deflate, PackBits"),
    "12 bits": ({"_258": (3, [12])}, "12-bit whole"),
    "signed": ({"_339": (3, [2])}, "8-bit signed"),
    "turned": ({"_274": (3, [6])}, "turned or mirrored"),
    "bits in reverse": ({"_266": (3, [2])}, "turned or mirrored"),
    "predictor": ({"_317": (3, [3])}, "no predictor 3"),
    "no strips": ({"_273": (4, [8, 8])}, "2 strips or tiles"),
    "no rows": ({"_278": (4, [0])}, "without a size"),
    "no width": ({"_256": (4, [0])}, "0 × "),
    "strip beyond": ({"_273": (4, [4_000_000_000])}, "cut off"),
    "strip short": ({"_279": (4, [10])}, "strip 0 does not hold"),
    "a fraction": ({"_256": (2, [1])}, "no such type"),
    "two depths": ({"_258": (3, [8, 16])}, "different values"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_other_sorts_are_refused(make, put, rng, case):
    """One line each: what it is, what is wanted."""
    changes, words = REFUSED[case]
    with pytest.raises(InputError, match=words) as caught:
        visint.io.read_image(put(make.tiff(picture(rng, "u1"), **changes)))
    assert str(caught.value).count("\n") == 1


@pytest.mark.parametrize("compression", ["LZW", "Deflate", "PackBits"])
def test_damage_that_libtiff_fills_up_is_refused(put, rng, compression):
    """Cut strips: OpenCV gives an image, visint one line."""
    done, data = cv2.imencode(
        ".tif", picture(rng, "u1"), [cv2.IMWRITE_TIFF_COMPRESSION, COMPRESSIONS[compression]]
    )
    assert done
    whole = bytearray(data.tobytes())
    whole[8:200] = bytes(192)
    with pytest.raises(InputError, match="does not hold the samples"):
        visint.io.read_image(put(bytes(whole)))


def test_every_cut_is_one_line(make, put, rng):
    """Wherever the file ends."""
    data = make.tiff(picture(rng, "u1"), rows=4)
    for end in range(4, len(data) - 4, 7):
        with pytest.raises(InputError, match=r"VI302.*(cut off|in no format|damaged|text)"):
            visint.io.read_image(put(data[:end]))


def test_sizes_are_checked_before_memory_is_taken(make, put, rng):
    """A header of gigapixels; a small image in a tile of gigabytes."""
    small = Limits(megapixels=1, megabytes=1)
    grey = picture(rng, "u1")
    with pytest.raises(InputError, match=r"VI303.*at most 1 MP"):
        visint.io.read_image(
            put(make.tiff(grey, _256=(4, [40_000]), _257=(4, [40_000]), _278=(4, [40_000]))), limits=small
        )
    with pytest.raises(InputError, match="VI303"):
        visint.io.read_image(
            put(make.tiff(grey, tile=(23, 37), _322=(4, [1 << 20]), _323=(4, [1 << 12]))), limits=small
        )
