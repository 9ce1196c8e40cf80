"""Moments of images whose spectrum is known, and what is no texture."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from visint.arrays import Array
from visint.module import Context
from visint_lab.render.rendering import render
from visint_lab.scenes.catalogue import scene
from visint_texture.moments import Moments, MomentsInputs, MomentsOutputs, MomentsParams


def measured(image: Array, **params: object) -> MomentsOutputs:
    return Moments(MomentsParams.model_validate(params)).run(MomentsInputs(image=image), Context())


@pytest.mark.parametrize("method", ["gabor", "tensor"])
def test_one_wave_has_its_own_moments(method: str):
    """A wave of frequency (u, v) has (u², 2uv, v²), in (cycles/px)²."""
    y, x = np.mgrid[:192, :192]
    image = (0.5 + 0.2 * np.cos(2 * np.pi * (0.07 * x - 0.04 * y))).astype(np.float32)
    found = measured(image, method=method, power=1).moments[96, 96]
    np.testing.assert_allclose(found, [0.07**2, -2 * 0.07 * 0.04, 0.04**2], rtol=0.12, atol=1e-4)


def test_moments_follow_scale(blobs: Callable[..., Array]):
    """Twice as fine a texture has four times the moments."""
    coarse, fine = (measured(blobs(3, f)[:256, :256]).moments.mean(axis=(0, 1)) for f in (0.06, 0.12))
    np.testing.assert_allclose(fine[[0, 2]] / coarse[[0, 2]], 4, rtol=0.2)


def test_noise_is_no_texture():
    """White noise has no scale of its own."""
    noise = 0.5 + 0.02 * np.random.default_rng(0).standard_normal((192, 192))
    assert measured(noise.astype(np.float32)).texture.max() == 0


@pytest.mark.parametrize("name", ["a/sphere/lambertian", "a/parallelepiped/lambertian+2%"])
def test_shading_and_outlines_are_no_texture(name: str):
    """Plain shaded objects, with and without noise: nothing but shading and a few edges."""
    assert measured(render(scene(name, 256), samples=2).left).texture.max() < 0.1


def test_blobs_are_texture(blobs: Callable[..., Array]):
    """A texture is seen as one nearly everywhere, also under a shadow that falls off slowly."""
    shade = np.linspace(0.3, 1, 256, dtype=np.float32)[None, :]
    assert (measured(blobs(4)[:256, :256] * shade).texture > 0.9).mean() > 0.9
