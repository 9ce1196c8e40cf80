"""Smoothing before matching: only where noise drowns the texture."""

from __future__ import annotations

import numpy as np
import pytest

from visint_stereo.semiglobal.calming import calmed


def test_a_clear_pair_is_left_alone(shifted):
    """No noise, and little noise on strong texture: the very arrays come back."""
    left, right = shifted(3.0)
    noisy = (left + np.random.default_rng(1).normal(0, 0.003, left.shape)).astype(np.float32)
    for view in (left, noisy):
        same, _, blur = calmed(view, right)
        assert blur == 0
        assert same is view


def test_drowned_texture_is_smoothed(shifted):
    """Noise of a fifth of full scale on that texture: both views are smoothed alike."""
    rng = np.random.default_rng(1)
    views = [(v + rng.normal(0, 0.2, v.shape)).astype(np.float32) for v in shifted(3.0)]
    left, right, blur = calmed(*views)
    assert blur >= 1
    assert left.std() < views[0].std()
    assert right.std() < views[1].std()


@pytest.mark.parametrize("value", [0.0, 0.5, np.nan])
def test_nothing_to_smooth(value):
    """Constant and unknown pairs pass unchanged."""
    blank = np.full((20, 30), value, np.float32)
    assert calmed(blank, blank)[2] == 0
