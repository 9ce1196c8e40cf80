"""A bowl and a sphere look alike: depth tells them apart."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Light
from visint.fields.geometry import normals_from_depth
from visint_shading.heights.gradients import square_to_light
from visint_shading.oliensis_dupuis import OliensisDupuis


@pytest.fixture(scope="module")
def pair(view):
    """A sphere lit from the very camera, and the depth of the bowl with the same image: ln Z mirrored at w₀."""
    seen = view("sphere", (-5.0, 0.0, 0.01))  # the left camera
    level = square_to_light(Light.at(0, 0, 0), seen.camera, 1.0)
    above = np.log(np.where(seen.figure, seen.depth, np.nan)) - level
    bowl = np.exp(level + 2 * np.nanmin(above) - above).astype(np.float32)
    return seen, bowl


def test_the_bowl_has_the_same_image(pair):
    """Brightness n·l of both, from geometry alone: equal to a thousandth."""
    seen, bowl = pair
    ray = (
        np.stack(np.meshgrid(np.arange(192) - 95.5, np.arange(192) - 95.5), axis=-1) / seen.camera.focal_length
    )
    ray = np.dstack([ray, np.ones((192, 192))])
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    inner = seen.away
    sphere = -(normals_from_depth(seen.depth, seen.camera) * ray).sum(axis=-1)[inner]
    hollow = -(normals_from_depth(bowl, seen.camera) * ray).sum(axis=-1)[inner]
    assert np.abs(sphere - hollow).max() < 0.01
    assert np.abs(sphere - hollow).mean() < 0.001


@pytest.mark.parametrize("hollow", [False, True])
def test_noisy_depth_decides(pair, hollow):
    """Depth with 1 % noise: convex or concave as it is, normals within 1.5° of the right one of the two."""
    seen, bowl = pair
    truth = bowl if hollow else np.where(seen.figure, seen.depth, np.nan).astype(np.float32)
    noise = np.random.default_rng(1).standard_normal(truth.shape).astype(np.float32)
    found = seen.run(OliensisDupuis, depth=truth * (1 + 0.01 * noise))
    normals = normals_from_depth(truth, seen.camera)
    there = seen.away & np.isfinite(found.normals.value[..., 2]) & np.isfinite(normals[..., 2])
    assert there.sum() > 0.9 * seen.away.sum()
    angle = np.degrees(np.arccos(np.clip((found.normals.value * normals).sum(axis=-1)[there], -1, 1)))
    assert angle.mean() < 1.5


def test_without_depth_the_parameter_decides(pair):
    """Convex unless told otherwise."""
    seen, bowl = pair
    both = [
        seen.run(OliensisDupuis, {"otherwise": way}).relief.value[seen.away] for way in ("convex", "concave")
    ]
    wanted = [seen.depth[seen.away], bowl[seen.away]]
    for found, truth in zip(both, wanted, strict=True):
        known = np.isfinite(found)
        assert np.corrcoef(found[known], truth[known])[0, 1] > 0.99
