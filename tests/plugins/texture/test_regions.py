"""Where texture is, and where one ends."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from visint.arrays import Array
from visint.module import Context
from visint_texture.moments import Moments, MomentsInputs
from visint_texture.regions import TextureRegions, TextureRegionsInputs


def found(image: Array, boundaries: Array | None = None) -> Array:
    seen = Moments().run(MomentsInputs(image=image), Context())
    inputs = TextureRegionsInputs(moments=seen.moments, texture=seen.texture, boundaries=boundaries)
    return TextureRegions().run(inputs, Context()).regions


def test_one_texture_is_one_region(blobs: Callable[..., Array]):
    """A homogeneous texture is not split."""
    assert set(np.unique(found(blobs(5)[:256, :256]))) <= {0, 1}


def test_a_bent_texture_is_one_region(slanted: Callable, blobs: Callable[..., Array]):
    """A slanted plane's moments change fivefold, but smoothly."""
    assert len(set(np.unique(found(slanted(blobs(6), 0.9, 0.4).image))) - {0}) == 1


def test_two_textures_are_two_regions(blobs: Callable[..., Array]):
    """A fine texture beside a coarse one: two regions that meet within a window of the edge."""
    image = blobs(7, 0.05)[:256, :256].copy()
    image[:, 128:] = blobs(8, 0.13)[:256, 128:256]
    labels = found(image)
    left, right = labels[64:192, 40], labels[64:192, 216]
    assert (left == left[0]).all()
    assert (right == right[0]).all()
    assert 0 < left[0] != right[0] > 0


def test_boundaries_are_respected(blobs: Callable[..., Array]):
    """One texture on both sides of a boundary is two problems."""
    wall = np.zeros((256, 256), bool)
    wall[:, 128] = True
    labels = found(blobs(9)[:256, :256], wall)
    assert 0 < labels[128, 60] != labels[128, 200] > 0
    assert (labels[wall] == 0).all()


def test_nothing_is_no_region():
    """A grey image has none."""
    assert (found(np.full((128, 128), 0.5, np.float32)) == 0).all()
