"""Superpixels: regions of like colour, known from pictures whose regions are known."""

from __future__ import annotations

import numpy as np
import pytest

from visint.module import Context
from visint_grouping.superpixels import Superpixels, SuperpixelsInputs, SuperpixelsParams


def regions_of(image, color=None, scale=1, **params):
    module = Superpixels(SuperpixelsParams(**params))
    inputs = SuperpixelsInputs(image=image, color=color)
    return module.run(inputs, Context(level=scale.bit_length() - 1)).regions


def squares(levels, side=30):
    """One row of even squares."""
    return np.repeat(np.tile(np.repeat(np.asarray(levels), side), (side, 1))[None], 1, axis=0)[0].astype(
        np.float32
    )


def test_even_squares_are_regions():
    """Three grey levels side by side are three regions, exact but for the smoothing at their borders."""
    found = regions_of(squares([0.1, 0.5, 0.9]))
    assert len(np.unique(found)) == 3
    truth = squares([1, 2, 3]).astype(int)
    inside = np.abs(np.arange(90)[None] % 30 - 14.5) < 12
    for label in (1, 2, 3):
        here = (truth == label) & inside
        assert len(np.unique(found[here])) == 1


def test_a_shade_is_one_region():
    """A ramp of even steps (to the eye) is nowhere cut, unlike by a split by means."""
    ramp = np.tile(np.linspace(0.2, 0.95, 200, dtype=np.float32) ** 2.4, (40, 1))
    assert regions_of(ramp).max() == 1


def test_colour_parts_what_brightness_does_not():
    """Red and green of one luminance are one region in grey and two in colour."""
    grey = np.full((30, 60), 0.2, np.float32)
    color = np.zeros((30, 60, 3), np.float32)
    color[:, :30, 0] = 0.2 / 0.2126
    color[:, 30:, 1] = 0.2 / 0.7152
    assert regions_of(grey).max() == 1
    assert regions_of(grey, color).max() == 2


@pytest.mark.parametrize("smallest", [20, 200])
def test_no_region_is_smaller(smallest):
    """``smallest`` holds, and every pixel has a label from 1 without gaps."""
    noise = np.random.default_rng(2).random((50, 60), dtype=np.float32)
    found = regions_of(noise, smallest=smallest, breadth=50)
    sizes = np.bincount(found.ravel())
    assert sizes[0] == 0
    assert sizes[1:].min() >= smallest


def test_lengths_are_in_full_size_pixels():
    """At half size a quarter of the pixels will do."""
    noise = np.random.default_rng(2).random((50, 60), dtype=np.float32)
    assert np.bincount(regions_of(noise, scale=2, smallest=400, breadth=50).ravel())[1:].min() >= 100


def test_more_breadth_gives_fewer_regions():
    noise = np.random.default_rng(2).random((80, 80), dtype=np.float32)
    counts = [regions_of(noise, breadth=breadth, smallest=5).max() for breadth in (20, 2000)]
    assert counts[1] < counts[0]
