"""Normals from exact images of known solids, each by the method meant for it."""

from __future__ import annotations

import numpy as np
import pytest

from visint_shading.oliensis_dupuis import OliensisDupuis
from visint_shading.slope import Slope

OBLIQUE = (0.0, float(np.sin(np.radians(20))), -float(np.cos(np.radians(20))))
BESIDE = (float(np.sin(np.radians(20))), 0.0, -float(np.cos(np.radians(20))))


class TestOliensisDupuis:
    @pytest.mark.parametrize("name", ["sphere", "cylinder", "paraboloid"])
    def test_light_behind_the_camera_and_nothing_known(self, view, name):
        """One singular point, or one line of them: its height is free and convex is right."""
        seen = view(name)
        assert seen.error(seen.run(OliensisDupuis).normals.value).mean() < 1.5

    def test_a_torus_whose_depth_is_known(self, view):
        """Several singular points, and a saddle among them: the map says which is what and how high."""
        seen = view("torus", size=256)
        found = seen.run(OliensisDupuis, depth=seen.depth)
        assert seen.error(found.normals.value).mean() < 1.5

    @pytest.mark.parametrize("lamp", [OBLIQUE, BESIDE])
    @pytest.mark.parametrize("name", ["sphere", "paraboloid"])
    def test_oblique_light(self, view, name, lamp):
        """20° off: heights grow away from the light, not from the camera."""
        seen = view(name, lamp)
        assert seen.error(seen.run(OliensisDupuis).normals.value).mean() < 3

    def test_light_at_a_point(self, view):
        """By the direction that each pixel has to it."""
        seen = view("sphere", (0.0, 0.0, -100.0))
        found = seen.run(OliensisDupuis, depth=seen.depth)
        assert seen.error(found.normals.value).mean() < 1.5

    def test_relief_is_the_depth_but_for_one_height(self, view):
        """Scale and shape come from the camera alone; the map gives the height of the singular point."""
        seen = view("sphere")
        relief = seen.run(OliensisDupuis, depth=seen.depth).relief.value
        known = seen.away & np.isfinite(relief)
        assert np.abs(relief - seen.depth)[known].max() < 0.35  # of a radius of 8.5

    def test_nothing_is_carried_across_a_boundary(self, view):
        """A sphere cut in two: the half without a singular point stays unknown."""
        seen = view("sphere")
        cut = seen.regions.copy()
        cut[:, 110:] = np.where(cut[:, 110:] > 0, 7, 0)
        found = seen.run(OliensisDupuis, depth=seen.depth, regions=cut)
        assert np.isfinite(found.relief.value[:, :110][seen.away[:, :110]]).mean() > 0.9
        assert np.isnan(found.relief.value[:, 112:]).all()

    def test_a_saddle_starts_nothing(self, view):
        """Its one singular point is neither convex nor concave: silence, where a guess would be wrong."""
        seen = view("saddle")
        assert np.isnan(seen.run(OliensisDupuis, depth=seen.depth).normals.value).all()

    def test_fig_3_5(self, view):
        """Taken for convex, as without a map, the saddle comes out wrong all over."""
        seen = view("saddle")
        assert seen.error(seen.run(OliensisDupuis).normals.value).mean() > 20


class TestSlope:
    @pytest.mark.parametrize("name", ["sphere", "cylinder", "paraboloid", "saddle", "torus"])
    def test_light_behind_the_camera_and_a_rough_map(self, view, name):
        """Direction from the map, slope from brightness: better than the map, saddles and tori included."""
        seen = view(name, size=256)
        assert seen.error(seen.run(Slope, depth=seen.roughly()).normals.value).mean() < 1.5

    @pytest.mark.parametrize("name", ["sphere", "cylinder", "paraboloid", "saddle", "torus"])
    def test_oblique_light(self, view, name):
        """The cone is about the true light, not about the line of sight."""
        seen = view(name, BESIDE, size=256)
        assert seen.error(seen.run(Slope, depth=seen.roughly()).normals.value).mean() < 3

    def test_a_saddle_behind_the_camera(self, view):
        """What singular points cannot do."""
        seen = view("saddle", size=256)
        assert seen.error(seen.run(Slope, depth=seen.roughly(noise=0.02)).normals.value).mean() < 1.5

    def test_brightness_is_kept(self, view):
        """Every normal has exactly the cosine that its brightness asks for."""
        seen = view("saddle")
        found = seen.run(Slope, depth=seen.depth, albedo=np.full_like(seen.image, 0.8))
        there = np.isfinite(found.normals.value[..., 2])
        cosine = found.normals.value[there] @ np.float32(seen.light.vector)
        assert np.abs(cosine - np.clip(seen.image[there] / 0.8, 0, 1)).max() < 1e-3

    def test_without_a_map_it_is_silent(self, view):
        assert (view("sphere").run(Slope).normals.reliability == 0).all()

    def test_sigma_covers_the_error(self, view):
        """At 2 % noise over half of the errors lie within one standard deviation, nearly all within three."""
        seen = view("sphere", noise=0.02, size=256)
        found = seen.run(Slope, depth=seen.roughly())
        there = seen.away & np.isfinite(found.normals.value[..., 2])
        error = np.arccos(np.clip((found.normals.value * seen.normals).sum(axis=-1)[there], -1, 1))
        assert (error < found.normals.sigma[there]).mean() > 0.5
        assert (error < 3 * found.normals.sigma[there]).mean() > 0.95
