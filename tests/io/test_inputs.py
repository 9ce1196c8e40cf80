"""A file as a graph input: exactly what its kind wants, or one line that says why not."""

from __future__ import annotations

import numpy as np
import pytest

import visint.io
from visint.arrays import SPECS, ArraySpec
from visint.errors import InputError, UsageError
from visint.fields import Camera

RED_GREEN_BLUE = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]], np.uint8)


def srgb(value):
    """IEC 61966-2-1, one number."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def test_the_curve_of_8_bit_files_is_undone(make, put):
    """Every one of the 256 samples by the standard's own formula."""
    samples = np.arange(256, dtype=np.uint8).reshape(16, 16)
    wanted = [srgb(sample / 255) for sample in range(256)]
    read = visint.io.read_image(put(make.png(samples)))
    np.testing.assert_allclose(read.ravel(), wanted, rtol=1e-6)
    assert read.min() == 0
    assert read.max() == 1


@pytest.mark.parametrize(
    ("gamma", "wanted"), [(None, srgb(128 / 255)), (1, 128 / 255), (2.2, (128 / 255) ** 2.2)]
)
def test_gamma_of_8_bits(make, put, gamma, wanted):
    """None undoes sRGB, 1 does nothing, another number is a power."""
    read = visint.io.read(put(make.png(np.array([[128]], np.uint8))), "Image", gamma=gamma)
    np.testing.assert_allclose(read, [[wanted]], rtol=1e-6)


@pytest.mark.parametrize(("gamma", "wanted"), [(None, 0.5), (1, 0.5), (2, 0.25)])
def test_gamma_of_16_bits_and_of_floats(make, put, gamma, wanted):
    """Both are linear unless told."""
    deep = np.array([[32768]], np.uint16)
    read = visint.io.read_image(put(make.png(deep, depth=16)), gamma=gamma)
    np.testing.assert_allclose(read, [[wanted]], rtol=1e-4)
    read = visint.io.read_image(put(make.pfm(np.array([[0.5]], np.float32))), gamma=gamma)
    np.testing.assert_allclose(read, [[wanted]], rtol=1e-6)


@pytest.mark.parametrize("gamma", [0, -1, float("nan"), float("inf")])
def test_a_gamma_that_is_none_is_refused(make, put, gamma):
    """Before any file is decoded."""
    with pytest.raises(UsageError, match="wants a number above 0"):
        visint.io.read_image(put(make.png(np.zeros((1, 1), np.uint8))), gamma=gamma)


def test_colour_becomes_an_image_by_luminance_of_linear_rgb(make, put):
    """0.2126 R + 0.7152 G + 0.0722 B."""
    read = visint.io.read_image(put(make.png(RED_GREEN_BLUE, 2)))
    np.testing.assert_allclose(read, [[0.2126, 0.7152, 0.0722, 1]], rtol=1e-6)
    assert read.max() <= 1


def test_luminance_stays_within_0_and_1(rng):
    """White is exactly 1, and no bright colour is above it."""
    color = 1 - rng.integers(0, 4, (64, 64, 3)).astype(np.float32) * np.float32(2**-24)
    assert visint.io.luminance(np.ones((1, 1, 3), np.float32)).tolist() == [[1]]
    assert visint.io.luminance(color).max() <= 1


def test_grey_in_three_channels_is_exactly_grey(make, put, rng):
    """No rounding by three weights where there is nothing to weigh."""
    grey = rng.integers(0, 256, (4, 5), dtype=np.uint8)
    one = visint.io.read_image(put(make.png(grey)))
    three = visint.io.read_image(put(make.png(np.repeat(grey[..., None], 3, 2), 2)))
    np.testing.assert_array_equal(one, three)


def test_grey_becomes_a_color_of_equal_channels(make, put):
    """From PNG, PFM and npy alike."""
    values = np.array([[0, 1]], np.float32)
    for data in (make.png((values * 255).astype(np.uint8)), make.pfm(values), make.stored(values)):
        read = visint.io.read_color(put(data))
        np.testing.assert_array_equal(read, np.repeat(values[..., None], 3, 2))


@pytest.mark.parametrize("kind", ["Image", "Color"])
@pytest.mark.parametrize("value", [-0.1, 1.1, 255])
def test_float_images_keep_to_0_to_1(make, put, kind, value):
    """An image in another range is refused: its scale would be a guess."""
    with pytest.raises(InputError, match=r"out of range; an? \w+ wants 0 to 1[\s\S]*array / array.max"):
        visint.io.read(put(make.stored(np.full((2, 2), value, np.float32))), kind)


EIGHT = np.array([[0, 255], [255, 0]], np.uint8)
FILES = {
    "PNG": lambda make: make.png(EIGHT),
    "PNG16": lambda make: make.png(EIGHT.astype(np.uint16) * 257, depth=16),
    "PNG colour": lambda make: make.png(np.dstack([EIGHT, EIGHT[::-1], EIGHT]), 2),
    "JPEG": lambda make: make.jpeg(EIGHT),
    "PGM": lambda make: b"P5 2 2 255\n" + EIGHT.tobytes(),
    "TIFF": lambda make: make.tiff(EIGHT),
    "float TIFF": lambda make: make.tiff(EIGHT.astype(np.float32) / 255),
    "PFM": lambda make: make.pfm(EIGHT.astype(np.float32) / 255),
    "PFM colour": lambda make: make.pfm(np.tile(np.float32([0, 0, -1]), (2, 2, 1))),
    "npy float": lambda make: make.stored(EIGHT.astype(np.float32) / 255),
    "npy int": lambda make: make.stored(EIGHT.astype(np.int64)),
    "npy small": lambda make: make.stored(np.array([[0, 5]])),
    "npy bool": lambda make: make.stored(EIGHT > 0),
    "npy normals": lambda make: make.stored(np.tile(np.float32([0, 0, -1]), (2, 2, 1))),
    "npy slopes": lambda make: make.stored(np.zeros((2, 2, 2), np.float32)),
    "npy numbers": lambda make: make.stored(np.zeros(3)),
}
TAKEN = {
    "Image": {"PNG", "PNG16", "PNG colour", "JPEG", "PGM", "TIFF", "float TIFF", "PFM", "npy float"},
    "Color": {"PNG", "PNG16", "PNG colour", "JPEG", "PGM", "TIFF", "float TIFF", "PFM", "npy float"},
    "Features": {"npy normals", "npy slopes"},
    "Depth": {"float TIFF", "PFM", "npy float"},
    "Relief": {"float TIFF", "PFM", "npy float"},
    "Disparity": {"PNG16", "float TIFF", "PFM", "npy float"},
    "Sigma": {"float TIFF", "PFM", "npy float"},
    "Confidence": {"PNG", "PNG16", "PGM", "TIFF", "float TIFF", "PFM", "npy float"},
    "Normals": {"PFM colour", "npy normals"},
    "Slopes": {"npy slopes"},
    "Incidence": {"float TIFF", "PFM", "npy float"},
    "Mask": {"PNG", "PNG16", "PGM", "TIFF", "npy bool"},
    "Boundaries": {"PNG", "PNG16", "PGM", "TIFF", "npy bool"},
    "Regions": {"PNG", "PNG16", "PGM", "TIFF", "npy int", "npy small"},
    "BoundaryKinds": {"npy small"},
    "Scalars": {"npy numbers"},
}


@pytest.mark.parametrize("kind", SPECS)
@pytest.mark.parametrize("file", FILES)
def test_every_format_is_either_exact_or_refused(make, put, kind, file):
    """The whole table: kind by kind, format by format."""
    path = put(FILES[file](make))
    if file in TAKEN[kind]:
        value = visint.io.read(path, kind)
        assert SPECS[kind].check(value) is value
        assert not value.flags.writeable
        assert value.flags.c_contiguous
    else:
        with pytest.raises(InputError) as caught:
            visint.io.read(path, kind)
        assert [problem.code for problem in caught.value.problems] == ["VI305"]
        assert "want" in str(caught.value) or "read from" in str(caught.value)


def test_a_camera_is_read_from_its_calibration(put):
    """The one kind that is no array."""
    text = "cam0=[9 0 1; 0 9 1; 0 0 1]\ndoffs=0\nbaseline=2\nwidth=3\nheight=4\n"
    camera = visint.io.read(put(text), "Camera")
    assert isinstance(camera, Camera)
    assert camera.size == (4, 3)


@pytest.mark.parametrize("kind", ["Light", "Scalar", "Flag", "Text", "Imgae", "flow.Flow"])
def test_other_kinds_are_refused_with_the_list(put, kind):
    """What is given in another way, and what there is not."""
    with pytest.raises(InputError, match=r"VI305[\s\S]*kinds read from files: Camera, Boundaries"):
        visint.io.read(put(b"x"), kind)


def test_a_plugins_own_kind_is_read_by_its_spec(make, put):
    """From npy and npz, under the last word of its name."""
    spec = ArraySpec("flow.Flow", "float32", ("H", "W", 2), "px")
    flow, other = np.ones((2, 3, 2), np.float32), np.zeros(1)
    assert visint.io.read(put(make.stored(None, flow=flow, other=other)), spec).shape == (2, 3, 2)
    with pytest.raises(InputError, match=r"is PNG; a flow.Flow is read from npy, npz"):
        visint.io.read(put(make.png(EIGHT)), spec)


def test_three_valued_masks_are_refused(make, put):
    """Middlebury's 128 (half occluded) has no one meaning; neither has the blur of a scaled mask."""
    with pytest.raises(InputError, match="3 grey values from 0 to 255; a Mask wants 0 and one other"):
        visint.io.read(put(make.png(np.array([[0, 128, 255]], np.uint8))), "Mask")


@pytest.mark.parametrize(
    ("samples", "wanted"),
    [([[0, 1]], [[False, True]]), ([[7, 7]], [[True, True]]), ([[0, 0]], [[False, False]])],
)
def test_two_valued_masks_are_what_is_not_zero(make, put, samples, wanted):
    """0 and 1, 0 and 255, or one value alone."""
    assert visint.io.read(put(make.png(np.array(samples, np.uint8))), "Mask").tolist() == wanted


def test_labels_of_few_bits_are_not_spread(make, put):
    """A 4-bit PNG's label 1 is 1, not 17."""
    labels = np.array([[0, 1, 2, 15]], np.uint8)
    assert visint.io.read(put(make.png(labels, depth=4)), "Regions").tolist() == labels.tolist()


def test_labels_beyond_32_bits_are_refused(make, put):
    """They would wrap round to other labels."""
    with pytest.raises(InputError, match="beyond int32"):
        visint.io.read(put(make.stored(np.array([[2**40]]))), "Regions")


def test_normals_are_held_to_the_frame(make, put):
    """Unit length, facing the camera; zeros are unknown, and told."""
    notes: list[str] = []
    normals = np.tile(np.float32([0, 0.6, -0.8]), (3, 3, 1))
    np.testing.assert_array_equal(visint.io.read(put(make.stored(normals)), "Normals"), normals)
    with pytest.raises(InputError, match="not of length 1"):
        visint.io.read(put(make.stored(normals * 2)), "Normals")
    with pytest.raises(InputError, match=r"face away[\s\S]*normals \* \(1, -1, -1\)"):
        visint.io.read(put(make.stored(-normals)), "Normals")
    normals[0, 0] = 0
    read = visint.io.read(put(make.stored(normals)), "Normals", note=notes.append)
    assert np.isnan(read[0, 0]).all()
    assert "1 normals are zero" in notes[0]


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (7, 7), (2, 31)], ids=str)
@pytest.mark.parametrize("file", ["png", "pgm", "pfm", "npy", "jpeg"])
def test_odd_sizes_keep_rows_and_columns_apart(make, put, rng, size, file):
    """(H, W) in, (H, W) out."""
    samples = rng.integers(0, 256, size, dtype=np.uint8)
    floats = samples.astype(np.float32) / 255
    data = {
        "png": lambda: make.png(samples),
        "pgm": lambda: f"P5 {size[1]} {size[0]} 255\n".encode() + samples.tobytes(),
        "pfm": lambda: make.pfm(floats),
        "npy": lambda: make.stored(floats),
        "jpeg": lambda: make.jpeg(samples),
    }[file]()
    read = visint.io.read_image(put(data), gamma=1)
    assert read.shape == size
    if file != "jpeg":
        np.testing.assert_allclose(read, floats, rtol=1e-6)


def test_srgb_there_and_back():
    """The picture of a linear image is the file it came from, sample by sample; unknown is black."""
    samples = np.arange(256)
    linear = visint.io.linear_from_srgb(samples / 255)
    np.testing.assert_array_equal(visint.io.srgb_from_linear(linear), samples)
    assert visint.io.srgb_from_linear(np.array([np.nan, -1, 2])).tolist() == [0, 0, 255]
