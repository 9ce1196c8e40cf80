"""Semi-global matching: known answers, degenerate pairs, and a real pair beside OpenCV's matcher."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Camera
from visint.module import Context
from visint_stereo.sgm import SemiGlobal, SemiGlobalInputs, SemiGlobalParams


def match(left, right, camera=None, **params):
    module = SemiGlobal(SemiGlobalParams(**params))
    return module.run(SemiGlobalInputs(left=left, right=right, camera=camera), Context(size=left.shape))


@pytest.mark.parametrize("shift", [0.3, 1.7, 23.4])
def test_a_shift_is_recovered(shifted, shift):
    """Sinusoids moved by a fraction of a pixel come back to 0.05 px in the interior (99 pixels of 100)."""
    found = match(*shifted(shift), min_disparity=0, max_disparity=32).disparity
    off = np.abs(found.value[8:-8, 40:-8] - shift)
    assert np.percentile(off, 99) < 0.05
    assert off.max() < 0.15
    assert found.reliability[8:-8, 40:-8].mean() > 0.9


def test_swapped_views_negate(shifted):
    """Looking from the other side turns the sign of every disparity."""
    left, right = shifted(5.3)
    there = match(left, right, min_disparity=-16, max_disparity=16).disparity.value
    back = match(right, left, min_disparity=-16, max_disparity=16).disparity.value
    assert np.median(np.abs(there + back)[8:-8, 30:-30]) < 0.1


def test_the_range_comes_from_the_camera_and_parameters_override_it(shifted):
    """A range that leaves out the truth cannot find it; a parameter widens it."""
    left, right = shifted(23.4)
    camera = Camera.uncalibrated(160, 96, (0, 8))
    inside = np.s_[8:-8, 40:-8]
    assert np.nanmax(match(left, right, camera).disparity.value) < 10
    wide = match(left, right, camera, max_disparity=30).disparity.value[inside]
    assert np.abs(wide - 23.4).max() < 0.15


@pytest.mark.parametrize("shift", [23.4, -17.2])
def test_the_range_is_estimated_where_nobody_gives_it(shifted, shift):
    """Without camera and parameters the pair itself shows its range, to either side."""
    found = match(*shifted(shift)).disparity.value[8:-8, 40:-40]
    assert np.abs(found - shift).max() < 0.15


@pytest.mark.parametrize("level", [0.0, 0.5, 1.0])
def test_a_constant_pair_says_nothing(level):
    """No texture, no disparity: reliability 0 everywhere, never a confident zero."""
    image = np.full((40, 60), level, np.float32)
    found = match(image, image)
    assert not found.disparity.reliability.any()
    assert np.isnan(found.disparity.value).all()
    assert not found.consistent.any()


def test_noise_is_not_believed():
    """Two unrelated noise images agree on next to nothing."""
    left, right = np.random.default_rng(3).random((2, 80, 120), dtype=np.float32)
    assert match(left, right).disparity.reliability.mean() < 0.25


@pytest.mark.parametrize("shape", [(1, 60), (60, 1), (2, 2), (1, 1)])
def test_odd_sizes_pass(shape):
    """One row, one column, one pixel: an answer of that size and no complaint."""
    left, right = np.random.default_rng(3).random((2, *shape), dtype=np.float32)
    assert match(left, right).disparity.value.shape == shape


def test_unknown_pixels_stay_unknown(shifted):
    """NaN intensity is no evidence; the rest is matched as if it were not there."""
    left, right = (view.copy() for view in shifted(4.0))
    left[20:30, 60:70] = np.nan
    right[60:64, 60:64] = np.nan
    found = match(left, right, min_disparity=0, max_disparity=16).disparity
    assert not found.reliability[20:30, 60:70].any()
    assert np.median(np.abs(found.value[8:-8, 90:-8] - 4)) < 0.1


def test_all_unknown_passes():
    """A pair of NaN is a pair about which nothing is known."""
    blank = np.full((20, 30), np.nan, np.float32)
    assert not match(blank, blank).disparity.reliability.any()


def test_the_left_border_survives(shifted):
    """Pixels whose match lies outside the right image are filled, not dropped, and believed less."""
    found = match(*shifted(23.4), min_disparity=0, max_disparity=32)
    assert np.isfinite(found.disparity.value[8:-8, :20]).all()
    trust = found.disparity.reliability[8:-8]
    assert trust[:, :14].mean() < 0.8 * trust[:, 40:].mean()
    assert np.abs(found.disparity.value[8:-8, :20] - 23.4).max() < 1


def _opencv(pair):
    """StereoSGBM (HH), its left border kept by padding; NaN where it says nothing."""
    import cv2

    views = [(255 * view ** (1 / 2.2)).round().astype(np.uint8) for view in (pair.left, pair.right)]
    padded = [cv2.copyMakeBorder(v, 0, 0, pair.levels, 0, cv2.BORDER_REPLICATE) for v in views]
    matcher = cv2.StereoSGBM_create(0, pair.levels, 3, 72, 288, 1, 63, 10, 100, 2, cv2.STEREO_SGBM_MODE_HH)
    found = matcher.compute(*padded)[:, pair.levels :] / np.float32(16)
    return np.where(found >= 0, found, np.nan)


@pytest.mark.parametrize(
    "scene",
    [
        "mb2014q/Piano",
        *(pytest.param(s, marks=pytest.mark.slow) for s in ("mb2006/Plastic", "mb2003/teddy", "mb2005/Art")),
    ],
)
def test_a_real_pair_is_matched_no_worse_than_opencv_does(real_pair, filled, bad, scene):
    """Share of pixels off by more than 2 px, both with holes filled by the smaller row neighbour."""
    pair = real_pair(scene)
    ours = match(pair.left, pair.right, min_disparity=0, max_disparity=pair.levels - 1).disparity
    assert bad(filled(ours.value), pair.truth) <= bad(filled(_opencv(pair)), pair.truth)


def test_reliability_tells_right_from_wrong_on_a_real_pair(real_pair):
    """The better half is wrong at least five times less often than the whole."""
    pair = real_pair("mb2014q/Piano")
    found = match(pair.left, pair.right, min_disparity=0, max_disparity=pair.levels - 1).disparity
    known = np.isfinite(pair.truth)
    wrong = ~(np.abs(found.value - pair.truth) <= 2)[known]
    trust = found.reliability[known]
    assert wrong[trust > np.median(trust)].mean() < 0.2 * wrong.mean()
