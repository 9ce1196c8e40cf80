"""The light, estimated from brightness and the map's normals."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Light
from visint_shading.light import LightOf

BESIDE = (0.34, 0.0, -0.94)
BELOW = (-0.6, 0.3, -0.7)


def angle(found, wanted):
    wanted = np.asarray(wanted) / np.linalg.norm(wanted)
    return np.degrees(np.arccos(np.clip(np.dot(found.vector, wanted), -1, 1)))


@pytest.mark.parametrize("lamp", [(0.0, 0.0, -1.0), BESIDE, BELOW])
@pytest.mark.parametrize("name", ["sphere", "paraboloid", "saddle", "torus"])
def test_within_five_degrees(view, name, lamp):
    """From a rough map and 2 % noise; the standard error says about how far off."""
    seen = view(name, lamp, noise=0.02)
    found = seen.run(LightOf, depth=seen.roughly(), light=Light.unknown())
    assert angle(found.light, lamp) < 5
    assert np.degrees(found.sigma) < 10
    assert found.reliability > 0.35


def test_ambient_light_is_told_apart(view):
    """0.3 of the albedo from everywhere; the true depth."""
    seen = view("sphere", BESIDE, ambient=0.25)
    found = seen.run(LightOf, depth=seen.depth, light=None)
    assert angle(found.light, BESIDE) < 5
    assert abs(found.ambient - 0.25) < 0.2


def test_a_cylinder_leaves_the_light_open(view):
    """All its normals lie in a plane: what the light does along the axis, no brightness shows."""
    found = view("cylinder", BELOW).run(LightOf, depth=view("cylinder", BELOW).depth, light=None)
    assert found.light.place == "unknown"
    assert found.reliability == 0


def test_paint_gives_no_light(view):
    seen = view("sphere")
    paint = np.random.default_rng(5).uniform(0.2, 1, (12, 12)).repeat(16, 0).repeat(16, 1).astype(np.float32)
    found = seen.run(LightOf, depth=seen.depth, image=seen.image * paint, light=None)
    assert found.light.place == "unknown"


def test_a_given_light_comes_out_as_it_is(view):
    seen = view("sphere")
    given = Light.at(1, 2, -30)
    found = seen.run(LightOf, depth=seen.depth, light=given)
    assert found.light == given
    assert found.sigma == 0
    assert found.reliability == 1


def test_without_a_map_there_is_none(view):
    assert view("sphere").run(LightOf, light=None).light.place == "unknown"
