"""The unsmoothed correction of a surface: right to first order, silent where it cannot know."""

from __future__ import annotations

import numpy as np

from visint.module import Context
from visint_stereo.attributes import Attributes, AttributesInputs
from visint_stereo.residual import Residual, ResidualInputs, ResidualParams


def correct(left, right, disparity, **params):
    images = Attributes().run(AttributesInputs(left=left, right=right), Context()).images
    return (
        Residual(ResidualParams(**params))
        .run(ResidualInputs(attributes=images, disparity=disparity), Context())
        .disparity
    )


def test_a_surface_slightly_off_is_put_right(shifted):
    """0.2 px off: where brightness changes, d - r/J is right to a tenth of that."""
    left, right = shifted(3.2)
    found = correct(left, right, np.full(left.shape, 3.0, np.float32))
    sharp = found.sigma < np.nanpercentile(found.sigma, 50)
    sharp[:8], sharp[-8:], sharp[:, :8], sharp[:, -8:] = False, False, False, False
    assert np.median(np.abs(found.value[sharp] - 3.2)) < 0.02


def test_sigma_tells_the_error(shifted):
    """With noise, errors divided by sigma have a robust spread near 1."""
    rng = np.random.default_rng(7)
    views = [(v + rng.normal(0, 0.02, v.shape)).clip(0, 1).astype(np.float32) for v in shifted(3.0)]
    found = correct(*views, np.full(views[0].shape, 3.0, np.float32), reach=20.0)
    core = np.s_[8:-8, 8:-8]
    z = np.abs((found.value[core] - 3) / found.sigma[core])
    assert 0.7 < np.nanmedian(z) / 0.6745 < 1.4


def test_far_corrections_are_not_believed(shifted):
    """Beyond ``reach`` the residual is no longer linear: reliability falls to 0 there."""
    left, right = shifted(9.0)
    found = correct(left, right, np.full(left.shape, 3.0, np.float32), reach=1.0)
    off = np.abs(found.value - 3)
    assert np.nanmax(off) <= 1.0


def test_hidden_and_outside_pixels_are_silent(shifted):
    """Behind something nearer in the right view, or beyond its border, nothing is said."""
    left, right = shifted(0.0)
    disparity = np.zeros(left.shape, np.float32)
    disparity[:, 80:110] = 12
    found = correct(left, right, disparity, reach=100.0)
    assert not found.reliability[:, 70:78].any()
    disparity[:, 80:110] = 0
    disparity[:, :10] = 12
    assert not correct(left, right, disparity).reliability[:, :10].any()


def test_without_texture_nothing_is_said():
    """A constant pair: reliability 0 everywhere."""
    image = np.full((20, 30), 0.4, np.float32)
    assert not correct(image, image, np.zeros((20, 30), np.float32)).reliability.any()
