"""The light: directions towards it from every surface point."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from visint.fields import Light

POINTS = np.array([[[0, 0, 10], [3, 0, 10], [0, -4, 13]]], np.float32)


class TestDistant:
    def test_it_is_a_unit_vector(self):
        """Right behind the camera is (0, 0, −1), whatever length it was given with."""
        assert Light.distant(0, 0, -7) == Light.distant(0, 0, -1)
        assert Light.distant(0, 0, -7).vector == (0, 0, -1)
        assert np.linalg.norm(Light.distant(1, 2, -3).vector) == pytest.approx(1)

    @pytest.mark.parametrize("scale", [1e-200, 1e-5, 1e200])
    def test_of_any_length(self, scale):
        """Neither tiny nor huge vectors are lost in their squares."""
        assert Light.distant(3 * scale, 0, -4 * scale).vector == pytest.approx((0.6, 0, -0.8))

    @pytest.mark.parametrize("vector", [(0, 0, 0), (np.nan, 0, 1), (np.inf, 0, 0)])
    def test_no_direction_is_refused(self, vector):
        with pytest.raises(ValueError, match="wants a direction"):
            Light.distant(*vector)

    def test_it_is_the_same_from_everywhere(self):
        towards = Light.distant(0.6, 0, -0.8).directions(POINTS)
        assert towards.shape == (3,)
        assert towards.dtype == np.float32
        np.testing.assert_allclose(np.broadcast_to(towards, POINTS.shape)[0, 2], [0.6, 0, -0.8], rtol=1e-6)


class TestAtAPoint:
    def test_directions_point_to_it(self):
        """From (3, 0, 10) to a light at (0, 4, 10): (−3, 4, 0)/5."""
        towards = Light.at(0, 4, 10).directions(POINTS)
        assert towards.shape == POINTS.shape
        assert towards.dtype == np.float32
        np.testing.assert_allclose(towards[0, 1], [-0.6, 0.8, 0], rtol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(towards, axis=-1), 1, rtol=1e-6)

    def test_far_away_it_is_distant(self):
        towards = Light.at(0, 0, -1e6).directions(POINTS)
        np.testing.assert_allclose(towards, np.broadcast_to([0, 0, -1], towards.shape), atol=1e-5)

    def test_at_the_light_there_is_no_direction(self):
        """And unknown points have none either; nobody is warned."""
        points = np.array([[[1, 2, 3], [np.nan] * 3]], np.float32)
        assert np.isnan(Light.at(1, 2, 3).directions(points)).all()

    def test_it_must_be_somewhere(self):
        with pytest.raises(ValidationError):
            Light.at(np.nan, 0, 0)


class TestUnknown:
    def test_it_has_no_directions(self):
        with pytest.raises(ValueError, match="the light is unknown"):
            Light.unknown().directions(POINTS)

    @pytest.mark.parametrize("light", [Light.unknown(), Light.at(1, 2, 3), Light.distant(0, 1, -1)])
    def test_every_light_survives_json(self, light):
        assert Light.model_validate_json(light.model_dump_json()) == light

    @pytest.mark.parametrize(
        "parts",
        [
            {"place": "distant"},
            {"place": "point"},
            {"place": "unknown", "vector": (0, 0, -1)},
            {"place": "distant", "vector": (0, 0, -2)},
            {"place": "somewhere"},
        ],
        ids=str,
    )
    def test_half_a_light_is_refused(self, parts):
        """What a run record or a caller may get wrong: no vector, one too many, one that is not unit."""
        with pytest.raises(ValidationError):
            Light.model_validate(parts)
