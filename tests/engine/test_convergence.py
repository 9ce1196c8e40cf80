"""The relative change of a value, from its definition ‖b − a‖ / ‖b‖ over what is finite in both."""

from __future__ import annotations

import math

import numpy as np
import pytest

from visint.engine.convergence import relative_change
from visint.fields import DepthEvidence


@pytest.mark.parametrize(
    ("before", "after", "wanted"),
    [
        (1.0, 1.0, 0.0),
        (1.0, 2.0, 0.5),
        (2.0, 1.0, 1.0),
        (-1.0, 1.0, 2.0),
        (0.0, 0.0, 0.0),
        (1.0, 0.0, math.inf),
        (0.0, 5.0, 1.0),
        (True, True, 0.0),
        (False, True, 1.0),
        (3, 4, 0.25),
    ],
)
def test_of_numbers(before, after, wanted):
    assert relative_change(before, after) == wanted


def test_of_arrays():
    """(3, 4) after (0, 0): ‖(3, 4)‖/‖(3, 4)‖ = 1; from (3, 3): 1/5."""
    after = np.array([[3.0, 4.0]], np.float32)
    assert relative_change(np.zeros_like(after), after) == 1
    assert relative_change(np.array([[3.0, 3.0]], np.float32), after) == pytest.approx(1 / 5)


def test_counts_what_is_finite_in_both():
    """A pixel unknown in either turn takes no part, neither in the change nor in the length."""
    before = np.array([np.nan, 3.0, 7.0, np.inf])
    after = np.array([1e6, 4.0, np.nan, 1.0])
    assert relative_change(before, after) == pytest.approx(1 / 4)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (None, 1.0),
        (1.0, None),
        (None, None),
        (np.nan, 1.0),
        (np.full((2, 2), np.nan), np.ones((2, 2))),
        (np.ones((2, 2)), np.ones((2, 3))),
        (np.ones((0, 2)), np.ones((0, 2))),
    ],
)
def test_is_nan_where_nothing_can_be_compared(before, after):
    assert math.isnan(relative_change(before, after))


def test_of_evidence_is_that_of_its_value():
    value = np.array([[1.0, np.nan]], np.float32)
    before, after = DepthEvidence.of(value, 1.0, 1.0), DepthEvidence.of(2 * value, 9.0, 0.1)
    assert relative_change(before, after) == 0.5


def test_of_booleans_and_lists():
    """Masks change by the share of pixels that flipped (rms), lists member by member."""
    before, after = np.array([[True, True, False]]), np.array([[True, False, True]])
    assert relative_change(before, after) == 1
    assert relative_change((1.0, 2.0), (1.0, 2.0)) == 0


def test_does_not_overflow_on_float32():
    """The sums are done in float64: 1e30² is beyond float32."""
    big = np.full((4, 4), 1e30, np.float32)
    assert relative_change(big, 2 * big) == pytest.approx(0.5)


def test_of_what_is_no_number_is_unknown():
    """A camera or a text has no size of change."""
    assert math.isnan(relative_change("a", "b"))
    assert math.isnan(relative_change(object(), object()))
