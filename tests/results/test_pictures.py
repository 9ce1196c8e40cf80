"""Fields as pictures."""

from __future__ import annotations

import numpy as np
import pytest

from visint.results import pictures

GREY = [pictures.UNKNOWN] * 3


def test_scalars_go_from_blue_to_red_and_unknown_is_grey():
    value = np.array([[0, 1, np.nan, np.inf]], np.float32)
    low, high, *unknown = pictures.of_scalar(value, 0, 1)[0].astype(int)
    assert low[2] > low[1]
    assert high[0] > max(high[1], high[2])
    assert [one.tolist() for one in unknown] == [GREY, GREY]


def test_values_outside_the_range_have_the_colours_of_its_ends():
    picture = pictures.of_scalar(np.array([[-9, 0, 1, 9]], np.float32), 0, 1)[0]
    np.testing.assert_array_equal(picture[0], picture[1])
    np.testing.assert_array_equal(picture[2], picture[3])


def test_the_unknown_grey_is_no_colour_of_the_scale():
    """Nor is it one of a normal: the grey in the middle would be the normal (0, 0, 0)."""
    colors = pictures.turbo(np.arange(256, dtype=np.uint8)[None])[0].astype(int)
    assert np.abs(colors - GREY).max(axis=1).min() > 40


@pytest.mark.parametrize(
    ("value", "wanted"),
    [([1, 1, 1], (0.5, 1.5)), ([-5, -5], (-7.5, -2.5)), ([np.nan, np.nan], (0, 1)), ([0, np.nan], (-0.5, 0.5))],
)
def test_the_range_is_never_empty(value, wanted):
    """A constant lies in the middle of its own; where nothing is known it is 0 to 1."""
    assert pictures.span(np.array([value], np.float32)) == wanted


def test_the_range_leaves_outliers_out():
    value = np.append(np.linspace(0, 1, 999), 1e30).astype(np.float32).reshape(10, 100)
    low, high = pictures.span(value)
    assert 0 < low < 0.05
    assert 0.95 < high < 1


def test_the_largest_numbers_do_not_overflow():
    most = np.finfo(np.float32).max
    value = np.array([[-most, most]], np.float32)
    assert pictures.of_scalar(value, *pictures.span(value)).shape == (1, 2, 3)


def test_confidence_is_grey():
    picture = pictures.of_confidence(np.array([[0, 0.5, 1, np.nan]], np.float32))
    assert picture[0, :, 0].tolist() == [0, 127, 255, 0]
    assert (picture == picture[..., :1]).all()


def test_normals_are_red_to_the_right_green_up_blue_to_the_camera():
    normals = np.array([[[1, 0, 0], [0, -1, 0], [0, 0, -1], [np.nan] * 3]], np.float32)
    picture = pictures.of_normals(normals)[0]
    assert picture.argmax(axis=1)[:3].tolist() == [0, 1, 2]
    assert picture[3].tolist() == GREY


def test_masks_are_white_where_set():
    assert pictures.of_mask(np.array([[True, False]]))[0, :, 1].tolist() == [255, 0]


def test_regions_differ_and_boundaries_are_black():
    picture = pictures.of_regions(np.array([[0, 1, 2, 3]], np.int32))[0]
    assert not picture[0].any()
    assert len({tuple(color) for color in picture}) == 4


def test_images_look_as_on_a_screen():
    """The sRGB curve: linear 0.2140 is the grey 127.5/255 = 0.5 of a screen, so 128 here."""
    picture = pictures.of_image(np.array([[0, 0.2158, 1, np.nan]], np.float32))
    assert picture[0, :, 0].tolist() == [0, 128, 255, 0]
    color = np.zeros((2, 3, 3), np.float32)
    assert pictures.of_image(color).shape == (2, 3, 3)


def test_the_reference_is_the_first_image(met, toys):
    np.testing.assert_array_equal(pictures.of_reference(met), pictures.of_image(met.inputs["left"]))
    assert pictures.of_reference(toys.run(toys.SCALARS)) is None
