"""The four attribute images and the noise they are scaled by."""

from __future__ import annotations

import numpy as np
import pytest

from visint.module import Context
from visint_stereo.attributes import Attributes, AttributesInputs, AttributesParams
from visint_stereo.descent.attribute_images import attributes
from visint_stereo.noise import noise_of


def run(views, **params):
    module = Attributes(AttributesParams(**params))
    return module.run(AttributesInputs(left=views[0], right=views[1]), Context()).images


def test_a_ramp_has_its_slope_and_no_curvature():
    """Intensity 0.01 x + 0.02 y: gradient √5 · 2.55 grades a pixel, curvature 0."""
    y, x = np.mgrid[:30, :40].astype(np.float32)
    images = attributes(0.01 * x + 0.02 * y, 1.0)[8:-8, 8:-8]
    np.testing.assert_allclose(images[..., 0], 255 * (0.01 * x + 0.02 * y)[8:-8, 8:-8], rtol=1e-4)
    np.testing.assert_allclose(images[..., 1], 2.55 * np.sqrt(5), rtol=1e-3)
    np.testing.assert_allclose(images[..., 2:], 0, atol=1e-3)


def test_a_bowl_curves_one_way_and_a_hill_the_other():
    """r²/1000: isophote curvature times gradient is 2 · 255/1000 everywhere; its negative is a hill."""
    y, x = np.mgrid[-20:21, -20:21].astype(np.float32)
    bowl = attributes((x**2 + y**2) / 1000, 1.0)
    ring = (np.hypot(x, y) > 6) & (np.hypot(x, y) < 15)
    np.testing.assert_allclose(bowl[..., 2][ring], 0.51, rtol=0.1)
    assert bowl[..., 3][ring].max() == 0
    hill = attributes(1 - (x**2 + y**2) / 1000, 1.0)
    np.testing.assert_allclose(hill[..., 3][ring], 0.51, rtol=0.1)


def test_attributes_turn_with_the_image(shifted):
    """All four are the same after a quarter turn of the image."""
    image = shifted(0.0)[0]
    turned = attributes(np.ascontiguousarray(np.rot90(image)), 1.0)
    np.testing.assert_allclose(np.rot90(attributes(image, 1.0)), turned, atol=1e-2)


@pytest.mark.parametrize("noise", [0.005, 0.02, 0.1])
def test_noise_is_measured_through_texture_and_clipping(shifted, noise):
    """Within a fifth, on a picture whose lower half is black and so clipped."""
    image = shifted(0.0)[0].repeat(2, axis=0).copy()
    image[96:] = 0
    noisy = (image + np.random.default_rng(5).normal(0, noise, image.shape)).clip(0, 1)
    assert abs(noise_of(noisy.astype(np.float32)) / noise - 1) < 0.2


def test_noise_scales_the_attributes(shifted):
    """Four times the noise, power 1: half the size, so that a fixed smoothness counts four times as much."""
    rng = np.random.default_rng(6)
    quiet, loud = (
        [np.clip(v * 0.5 + 0.25 + rng.normal(0, n, v.shape), 0, 1).astype(np.float32) for v in shifted(0.0)]
        for n in (0.02, 0.08)
    )
    scaled, plain = ([run(views, noise_power=power) for views in (quiet, loud)] for power in (1.0, 0.0))
    ratios = [s[0][48, 80, 0] / p[0][48, 80, 0] for s, p in zip(scaled, plain, strict=True)]
    assert abs(ratios[0] / ratios[1] - 2) < 0.3


def test_unknown_pixels_spoil_nothing_far_away(shifted):
    """NaN intensity becomes the image's mean; attributes are finite everywhere."""
    left, right = shifted(1.0)
    holed = left.copy()
    holed[10:20, 10:20] = np.nan
    assert np.isfinite(run((holed, right))[0]).all()
