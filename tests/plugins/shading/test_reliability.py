"""Where shading may speak, and where it must not."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Light
from visint.module import Context
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_shading.incidence import IncidenceOf
from visint_shading.slope import Slope


def incidence(view, **given):
    return view.run(IncidenceOf, **given).incidence


class TestIncidence:
    @pytest.mark.parametrize("name", ["sphere", "saddle"])
    def test_it_is_the_cosine_to_the_light(self, view, name):
        """Brightness over albedo, within sigma nearly everywhere."""
        seen = view(name, noise=0.02)
        found = incidence(seen, depth=seen.roughly())
        there = seen.away & (found.reliability > 0)
        error = np.abs(found.value - seen.normals @ np.float32(seen.light.vector))[there]
        assert (error < 2 * found.sigma[there]).mean() > 0.9

    def test_given_albedo_is_used(self, view):
        """Half the brightness at half the albedo is the same angle."""
        seen = view("sphere")
        one = incidence(seen, depth=seen.depth, albedo=np.full_like(seen.image, 0.8))
        half = incidence(seen, depth=seen.depth, albedo=np.full_like(seen.image, 0.4), image=seen.image / 2)
        there = seen.away & (one.reliability > 0) & (half.reliability > 0)
        np.testing.assert_allclose(one.value[there], half.value[there], atol=1e-4)


class TestReliability:
    @pytest.mark.parametrize("name", ["sphere", "cylinder", "paraboloid", "saddle", "torus"])
    def test_plain_surfaces_are_trusted(self, view, name):
        seen = view(name, noise=0.02)
        assert incidence(seen, depth=seen.roughly()).reliability[seen.away].mean() > 0.6

    def test_nothing_is_said_outside_the_figure(self, view):
        seen = view("sphere")
        assert (incidence(seen, depth=seen.depth).reliability[~seen.figure] == 0).all()

    def test_nothing_is_said_where_the_light_is_faced(self, view):
        """There a slope hardly changes brightness: reliability goes to 0 with the angle."""
        seen = view("sphere")
        found = incidence(seen, depth=seen.depth)
        cosine = seen.normals @ np.float32(seen.light.vector)
        assert found.reliability[cosine > 0.9995].max(initial=0) < 0.15
        assert found.reliability[(cosine < 0.9) & seen.away].mean() > 0.9

    def test_shadow_is_silent(self, view):
        """Beyond 85° from the light."""
        seen = view("sphere", (0.0, 0.8, -0.6))
        found = incidence(seen, depth=seen.depth)
        dark = seen.figure & (seen.normals @ np.float32(seen.light.vector) < 0.08)
        assert dark.any()
        assert found.reliability[dark].max() < 0.05

    def test_highlights_are_silent(self, view):
        """Given ones, and what is saturated."""
        seen = view("sphere")
        spot = np.zeros(seen.image.shape, bool)
        spot[90:100, 90:100] = True
        assert (incidence(seen, depth=seen.depth, highlights=spot).reliability[spot] == 0).all()
        bright = np.where(spot, np.float32(1), seen.image)
        assert (incidence(seen, depth=seen.depth, image=bright).reliability[spot] == 0).all()

    def test_a_painted_surface_is_silent(self, view):
        """Stripes of another albedo in one region."""
        seen = view("sphere")
        stripes = (np.arange(192) // 12 % 2 == 0)[None] * np.float32(0.5) + np.float32(0.5)
        assert incidence(seen, depth=seen.depth, image=seen.image * stripes).reliability.mean() < 0.01

    def test_a_wrong_map_is_not_confirmed(self, view):
        """A plane where the image shows a sphere: nothing confirms the model, shading waits."""
        seen = view("sphere")
        assert (incidence(seen, depth=np.full_like(seen.depth, 50)).reliability == 0).all()

    def test_a_wrong_light_is_not_confirmed(self, view):
        seen = view("sphere")
        found = incidence(seen, depth=seen.depth, light=Light.distant(1, 0, -0.3))
        assert found.reliability.mean() < 0.02

    def test_an_unknown_light_is_estimated(self, view):
        seen = view("sphere", noise=0.02)
        found = seen.run(Slope, depth=seen.roughly(), light=None)
        assert found.normals.reliability[seen.away].mean() > 0.6
        assert seen.error(found.normals.value).mean() < 4

    def test_without_any_map_it_is_believed_little(self, view):
        found = incidence(view("sphere"))
        assert 0 < found.reliability.max() <= 0.3

    @pytest.mark.parametrize("name", ["sphere", "parallelepiped"])
    def test_checkers_are_silent(self, name):
        """With the true depth and regions."""
        seen = render(scene(f"b/{name}/checker", 192, seed=7), samples=2)
        regions = np.where(seen.truth.foreground, seen.truth.regions, 0)
        given = {"image": seen.left, "depth": seen.truth.depth, "regions": regions, "light": seen.light}
        module = IncidenceOf(IncidenceOf.Params(window=4.5))
        found = module.run(IncidenceOf.Inputs(**given, camera=seen.camera), Context(size=(192, 192)))
        assert found.incidence.reliability[seen.truth.foreground].mean() < 0.1


class TestPremises:
    def test_where_they_held_is_told_by_region(self, view):
        """A sphere and a painted sphere: Lambertian reflectance holds in one of the two regions."""
        seen = view("sphere")
        told = {}

        def note(what, name, value):
            if what == "assumed":
                told[name] = value

        stripes = (np.arange(192) // 12 % 2 == 0)[None] * np.float32(0.5) + np.float32(0.5)
        image = np.hstack([seen.image, seen.image * stripes])
        regions = np.hstack([(seen.regions > 0) * 1, (seen.regions > 0) * 2]).astype(np.int32)
        inputs = IncidenceOf.Inputs(
            image=image, depth=np.hstack([seen.depth] * 2), regions=regions, light=Light.distant(0, 0, -1)
        )
        IncidenceOf(IncidenceOf.Params(window=4.5)).run(inputs, Context(size=image.shape, note=note))
        held, labels = told["piecewise_constant_albedo"]
        assert held.tolist()[1:] == [True, False]
        assert labels.shape == image.shape
