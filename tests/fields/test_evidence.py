"""Evidence: value, sigma and reliability always agree on where the cue speaks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from pydantic import ValidationError

from visint.fields import (
    KINDS,
    BoundariesEvidence,
    DepthEvidence,
    DisparityEvidence,
    Evidence,
    IncidenceEvidence,
    NormalsEvidence,
    SlopesEvidence,
    known,
)
from visint.testing import strategies

NAN = np.nan


def f32(values):
    return np.array(values, np.float32)


class TestOf:
    def test_any_of_the_three_may_abstain(self):
        """NaN value; sigma not finite or not positive; reliability 0 or NaN: all three say nothing then."""
        value = f32([[1, NAN, 1, 1, 1, 1, 1, 1]])
        sigma = f32([[1, 1, NAN, 0, -1, np.inf, 1, 1]])
        trust = f32([[1, 1, 1, 1, 1, 1, 0, NAN]])
        evidence = DepthEvidence.of(value, sigma, trust)
        speaks = [[True] + [False] * 7]
        assert (evidence.reliability > 0).tolist() == speaks
        assert np.isfinite(evidence.value).tolist() == speaks
        assert np.isfinite(evidence.sigma).tolist() == speaks

    def test_numbers_broadcast_and_reliability_is_clipped(self):
        evidence = DisparityEvidence.of(f32([[1, 2], [3, 4]]), 0.5, 1.5)
        assert (evidence.sigma == 0.5).all()
        assert (evidence.reliability == 1).all()
        assert DisparityEvidence.of(f32([[1]]), 1, -0.5).reliability == 0

    def test_one_missing_channel_silences_a_pixel(self):
        slopes = f32([[[1, NAN], [1, 2]]])
        evidence = SlopesEvidence.of(slopes, 0.1, 1.0)
        assert np.isnan(evidence.value[0, 0]).all()
        assert evidence.reliability.tolist() == [[0, 1]]

    def test_incidence_is_about_depth(self):
        """A plain number a pixel, which depth and a light explain together."""
        evidence = IncidenceEvidence.of(f32([[0.5, NAN]]), 0.1, 1.0)
        assert KINDS[evidence.measures].constrains == "depth"
        assert evidence.reliability.tolist() == [[1, 0]]

    def test_boundaries_keep_their_value_where_they_abstain(self):
        """A bool cannot be NaN: reliability alone tells."""
        evidence = BoundariesEvidence.of(np.array([[True, False]]), 1.0, f32([[0, 1]]))
        assert evidence.value.tolist() == [[True, False]]
        assert evidence.reliability.tolist() == [[0, 1]]

    def test_what_goes_in_stays_as_it_was(self):
        value, sigma, trust = f32([[1, NAN]]), f32([[NAN, 1]]), f32([[1, 1]])
        DepthEvidence.of(value, sigma, trust)
        np.testing.assert_array_equal(value, [[1, NAN]])
        np.testing.assert_array_equal(sigma, [[NAN, 1]])

    def test_double_precision_is_rounded(self):
        """`of` is the door for calculations in double precision; the constructor refuses them."""
        assert DepthEvidence.of(np.ones((2, 2)), np.ones((2, 2)), np.ones((2, 2))).value.dtype == np.float32
        ones = np.ones((2, 2))
        with pytest.raises(ValidationError, match="this array is float64"):
            DepthEvidence(value=ones, sigma=f32(ones), reliability=f32(ones))

    @given(strategies.evidence("Normals"))
    def test_of_its_own_parts_is_itself(self, evidence):
        again = type(evidence).of(evidence.value, evidence.sigma, evidence.reliability)
        for part in ("value", "sigma", "reliability"):
            np.testing.assert_array_equal(getattr(again, part), getattr(evidence, part))


class TestConstructor:
    def parts(self, **changed):
        whole = {"value": f32([[1, NAN]]), "sigma": f32([[1, NAN]]), "reliability": f32([[1, 0]])}
        return {**whole, **changed}

    def test_what_agrees_is_taken(self):
        assert DepthEvidence(**self.parts()).reliability.tolist() == [[1, 0]]

    def test_nothing_is_copied_and_nobody_can_write(self):
        parts = self.parts()
        evidence = DepthEvidence(**parts)
        assert np.shares_memory(evidence.value, parts["value"])
        assert not any(getattr(evidence, name).flags.writeable for name in parts)

    @pytest.mark.parametrize(
        ("changed", "complaint"),
        [
            ({"value": f32([[1, 2]])}, "NaN where reliability is not 0, or the reverse"),
            ({"value": f32([[NAN, NAN]])}, r"DepthEvidence.of\(...\) makes them agree"),
            ({"reliability": f32([[2, 0]])}, r"outside \[0, 1\]"),
            ({"reliability": f32([[NAN, 0]])}, r"outside \[0, 1\]"),
            ({"sigma": f32([[0, NAN]])}, "sigma is not positive where the evidence speaks"),
            ({"sigma": f32([[1]])}, "differ in size"),
            ({"value": f32([[[1, NAN]]])}, "this array has shape"),
            ({"value": [[1, 2]]}, "this is a list, not a numpy array"),
            ({"certainty": 1}, "Extra inputs are not permitted"),
        ],
        ids=lambda part: part if isinstance(part, str) else "",
    )
    def test_what_does_not_agree_is_refused(self, changed, complaint):
        """With what is wrong, and never with the contents of an array."""
        with pytest.raises(ValidationError, match=complaint) as refused:
            DepthEvidence(**self.parts(**changed))
        assert "array(" not in str(refused.value)

    def test_it_is_frozen(self):
        with pytest.raises(ValidationError, match="frozen"):
            DepthEvidence(**self.parts()).value = f32([[1]])


class TestKnown:
    def test_of_maps_channels_and_labels(self):
        assert known(f32([[1, NAN, np.inf]])).tolist() == [[True, False, False]]
        assert known(f32([[[1, 2], [1, NAN]]])).tolist() == [[True, False]]
        assert known(np.array([[0, 1]], np.int32)).tolist() == [[True, True]]
        assert known(np.array([[True, False]])).all()
        assert known(np.zeros((2, 3, 4), bool)).shape == (2, 3)


def test_every_class_measures_a_kind_of_its_own():
    classes = [each for each in Evidence.__subclasses__() if each.__module__.startswith("visint.")]
    assert len({each.measures for each in classes}) == len(classes) == 7
    assert NormalsEvidence.measures == "Normals"
    assert all(each.__doc__ for each in classes)
