"""The matcher by descent: known answers, level by level, and what it says where it cannot know."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields.kinds import KINDS
from visint.fields.resampling import levels_down_to
from visint.module import Context
from visint_stereo.attributes import Attributes, AttributesInputs
from visint_stereo.weng import Weng, WengInputs, WengParams


def attributes(left, right):
    return Attributes().run(AttributesInputs(left=left, right=right), Context()).images


def off(found, truth):
    """How far 99 of 100 pixels lie from the truth at most."""
    return np.percentile(np.abs(found - truth), 99)


def coarse_to_fine(left, right, iterations=20, **params):
    """What graphs/stereo.yaml does, without the engine."""
    features, disparity = KINDS["Features"], KINDS["Disparity"]
    pyramid = [attributes(left, right)]
    for _ in range(levels_down_to(left.shape, 8) - 1):
        pyramid.append(tuple(features.downward(view) for view in pyramid[-1]))
    matcher = Weng(WengParams(iterations=iterations, **params))
    fields = {"disparity": None, "right_disparity": None}
    for level in reversed(range(len(pyramid))):
        found = matcher.run(WengInputs(attributes=pyramid[level], **fields), Context())
        if level:
            size = pyramid[level - 1][0].shape[:2]
            fields = {
                "disparity": disparity.upward(found.left, size),
                "right_disparity": disparity.upward(found.right, size),
            }
    return found


@pytest.mark.parametrize("shift", [0.3, 1.7, 23.4])
def test_a_shift_is_recovered(shifted, shift):
    """Sinusoids moved by a fraction of a pixel come back to 0.05 px in the interior, in both fields."""
    found = coarse_to_fine(*shifted(shift))
    assert off(found.left[8:-8, 40:-8], shift) < 0.05
    assert off(found.right[8:-8, 8:-40], shift) < 0.05
    assert found.disparity.reliability[8:-8, 40:-8].mean() > 0.8


def test_swapped_views_negate(shifted):
    """Looking from the other side turns the sign."""
    left, right = shifted(5.3)
    there, back = coarse_to_fine(left, right), coarse_to_fine(right, left)
    assert off(there.left[8:-8, 20:-20], 5.3) < 0.05
    assert off(back.left[8:-8, 20:-20], -5.3) < 0.05


@pytest.mark.parametrize("level", [0.0, 0.5, 1.0])
def test_a_constant_pair_says_nothing(level):
    """No texture: reliability 0 everywhere, never a confident zero; the fields stay finite."""
    image = np.full((40, 60), level, np.float32)
    found = coarse_to_fine(image, image)
    assert not found.disparity.reliability.any()
    assert np.isnan(found.disparity.value).all()
    assert np.isfinite(found.left).all()


def test_an_even_background_is_not_believed(shifted):
    """Beside a textured patch the even ground gets next to no reliability."""
    left, right = (view.copy() for view in shifted(2.0))
    left[:, 80:], right[:, 78:] = 0.5, 0.5
    trust = coarse_to_fine(left, right).disparity.reliability
    assert trust[10:-10, 110:].max() < 0.05
    assert trust[10:-10, 20:60].mean() > 0.7


def test_one_update_is_the_equation():
    """One pixel in the middle of a ramp: d = d̄ - Σ w J R / (λ + Σ w J²), by hand."""
    ramp = np.repeat(np.arange(32, dtype=np.float32)[None] * 4, 9, axis=0)
    left = np.zeros((9, 32, 4), np.float32)
    right = np.zeros((9, 32, 4), np.float32)
    left[..., 0], right[..., 0] = ramp, ramp + 2
    matcher = Weng(WengParams(smoothness=48.0, weights=(1, 0, 0, 0)))
    zero = np.zeros((9, 32), np.float32)
    found = matcher.run(WengInputs(attributes=(left, right), disparity=zero, right_disparity=zero), Context())
    # left: R = 2, J = -4; right: R = -2, J = +4; both: d = 8 / (48 + 16)
    assert np.isclose(found.left[4, 16], 8 / 64)
    assert np.isclose(found.right[4, 16], 8 / 64)


def test_boundaries_hold_smoothness_back():
    """A step of the disparity at a marked boundary stays a step; unmarked it blurs."""
    blank = (np.zeros((16, 32, 4), np.float32),) * 2
    step = np.zeros((16, 32), np.float32)
    step[:, 16:] = 2
    marks = np.zeros((16, 32), bool)
    marks[:, 15:17] = True
    matcher = Weng(WengParams(iterations=20, across=0.0001))
    inputs = {"attributes": blank, "disparity": step, "right_disparity": np.zeros_like(step)}
    free = matcher.run(WengInputs(**inputs), Context()).left
    held = matcher.run(WengInputs(**inputs, boundaries=marks), Context()).left
    assert free[8, 12] > 0.2
    assert held[8, 12] < 0.01
    assert held[8, 19] > 1.99


def test_unknown_disparity_is_taken_from_the_nearest(shifted):
    """A map with holes is no obstacle: a few updates from it give finite fields near the truth."""
    left, right = shifted(1.7)
    start = np.full(left.shape, 1.5, np.float32)
    start[20:40, 50:90] = np.nan
    matcher = Weng(WengParams(iterations=20))
    found = matcher.run(WengInputs(attributes=attributes(left, right), disparity=start), Context())
    assert off(found.left[8:-8, 20:-20], 1.7) < 0.1


def test_the_right_field_alone_suffices_too(shifted):
    """What is missing of the two fields is taken from the other view."""
    left, right = shifted(6.0)
    start = np.full(left.shape, 6.2, np.float32)
    matcher = Weng(WengParams(iterations=20))
    found = matcher.run(WengInputs(attributes=attributes(left, right), right_disparity=start), Context())
    assert off(found.left[8:-8, 20:-20], 6.0) < 0.1


@pytest.mark.parametrize("shape", [(1, 40), (40, 1), (2, 2), (1, 1)])
def test_odd_sizes_pass(shape):
    """One row, one column, one pixel: fields of that size and no complaint."""
    left, right = np.random.default_rng(3).random((2, *shape), dtype=np.float32)
    found = coarse_to_fine(left, right, iterations=2)
    assert found.left.shape == shape
    assert np.isfinite(found.left).all()


def test_noise_makes_no_difference_to_the_smoothness_wanted(shifted):
    """At 2 and at 10 % noise the same parameters give fields a quarter and six tenths of a pixel off."""
    rng = np.random.default_rng(4)
    for noise, limit in ((0.02, 0.25), (0.1, 0.6)):
        views = [(v + rng.normal(0, noise, v.shape)).clip(0, 1).astype(np.float32) for v in shifted(3.4)]
        found = coarse_to_fine(*views)
        assert np.sqrt(np.mean((found.left[8:-8, 20:-8] - 3.4) ** 2)) < limit
