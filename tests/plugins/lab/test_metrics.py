"""Metrics on cases whose numbers are known by hand."""

import numpy as np
import pytest

from visint.testing import ModuleContract
from visint_lab.metrics import (
    BoundaryScore,
    ConfidenceScore,
    DepthScore,
    DisparityScore,
    LabelScore,
    ShapeScore,
    arc_scores,
    boundary_scores,
    confidence_scores,
    depth_scores,
    disparity_scores,
    filled_from_rows,
    junction_scores,
    shape_scores,
    sparsification,
)

NAN = np.nan


def f32(*rows):
    return np.array(rows, dtype=np.float32)


def test_depth_errors_are_over_what_is_known_on_both_sides():
    """Errors 1 and 3 of three countable pixels: mse 5, rmse √5, median 2, density 2/3."""
    scores = depth_scores(f32([11, 13, NAN, 0]), f32([10, 10, 10, NAN]))
    assert scores == pytest.approx({"mse": 5, "rmse": 5**0.5, "median": 2, "density": 2 / 3})


def test_a_mask_takes_pixels_out():
    """Only the masked-in pixel counts; a mask of nothing gives NaN, not an error."""
    mask = np.array([[True, False, False, False]])
    assert depth_scores(f32([11, 13, NAN, 0]), f32([10, 10, 10, NAN]), mask)["mse"] == 1
    assert np.isnan(depth_scores(f32([1]), f32([1]), np.array([[False]]))["mse"])


def test_normals_a_right_angle_apart_differ_by_two():
    """|a − b|² = 2 for perpendicular unit vectors, their angle is π/2."""
    one, other = f32([[0, 0, -1], [0, 0, -1]]), f32([[1, 0, 0], [0, 0, -1]])
    scores = shape_scores(one, other)
    assert scores["s"] == pytest.approx(1.0)
    assert scores["mean_angle"] == pytest.approx(np.pi / 4)


def test_tiny_angles_are_not_lost():
    """An angle of 1e-4 rad is measured, though its cosine rounds to 1 in float32."""
    a = 1e-4
    scores = shape_scores(f32([[0, 0, -1]]), f32([[np.sin(a), 0, -np.cos(a)]]))
    assert scores["median_angle"] == pytest.approx(a, rel=1e-3)


def test_unknown_disparity_is_bad_but_has_no_error():
    """Errors 0.5, 1.5, 2.5 and a hole: bad-1 3/4, bad-2 2/4, mean of the three errors."""
    scores = disparity_scores(f32([10.5, 11.5, 12.5, NAN]), f32([10, 10, 10, 10]))
    assert scores == pytest.approx({"bad1": 0.75, "bad2": 0.5, "mae": 1.5, "density": 0.75})


def test_holes_take_the_smaller_of_their_two_neighbours():
    """Within a row from both sides, at its ends from one; a row of holes from the nearest row."""
    filled = filled_from_rows(f32([NAN, 5, NAN, NAN, 3, NAN], [NAN] * 6))
    np.testing.assert_array_equal(filled, f32([5, 5, 3, 3, 3, 3], [5, 5, 3, 3, 3, 3]))
    np.testing.assert_array_equal(filled_from_rows(f32([NAN, NAN])), f32([0, 0]))


def test_a_perfect_order_has_no_area_and_a_reversed_one_the_most():
    """AUSE is 0 if confidence falls with the error, and largest if it rises."""
    error = np.arange(1000, dtype=np.float64)
    perfect, reversed_, none = (sparsification(error, c).area for c in (-error, error, np.zeros_like(error)))
    assert perfect == 0
    assert 0 < none < reversed_
    assert none == pytest.approx(0.5, abs=0.01)  # curve 1, oracle falls linearly to 0


def test_risk_at_90_percent_leaves_the_least_trusted_tenth_out():
    """A tenth of the pixels is wrong by 10 and known to be: the risk of the rest is 0."""
    error, trust = np.zeros((10, 100)), np.ones((10, 100))
    error[0], trust[0] = 10, 0.1
    assert confidence_scores(error, trust)["risk90"] == 0
    assert confidence_scores(error, np.ones_like(trust))["risk90"] == pytest.approx(1.0)


def test_boundaries_two_pixels_off_are_found_and_three_are_not():
    """F is 1 for a line shifted by the tolerance, 0 beyond; precision counts false lines."""
    truth = np.zeros((20, 20), dtype=bool)
    truth[10] = True
    assert boundary_scores(np.roll(truth, 2, 0), truth)["f"] == 1
    assert boundary_scores(np.roll(truth, 3, 0), truth)["f"] == 0
    both = truth | np.roll(truth, 6, 0)
    scores = boundary_scores(both, truth)
    assert scores["precision"] == 0.5
    assert scores["recall"] == 1
    assert boundary_scores(np.zeros_like(truth), truth)["f"] == 0


def test_an_arc_is_right_by_the_majority_along_it():
    """Two arcs, one with the true label: half of the arcs are right; one far from every edge is wrong."""
    truth = np.zeros((20, 20), dtype=np.int32)
    truth[5], truth[12] = 1, 3
    arcs, labels = np.zeros_like(truth), np.zeros_like(truth)
    arcs[6], arcs[12], labels[6], labels[12] = 1, 2, 1, 2
    assert arc_scores(arcs, labels, truth)["right"] == 0.5
    arcs[18], labels[18] = 3, 1
    assert arc_scores(arcs, labels, truth)["right"] == pytest.approx(1 / 3)


def test_junctions_are_matched_once_each():
    """One of two is met by its type; a second found beside the first is extra."""
    truth = np.array([[10, 10, 1], [30, 30, 2]])
    found = np.array([[11, 10, 1], [9, 10, 1], [31, 31, 3]])
    scores = junction_scores(found, truth)
    assert scores == {"right": 0.5, "found": 1.0, "extra": 0.5}


class TestBoundaryScore(ModuleContract):
    module = BoundaryScore
    instant = True


class TestConfidenceScore(ModuleContract):
    module = ConfidenceScore
    instant = True


class TestDepthScore(ModuleContract):
    module = DepthScore
    instant = True


class TestDisparityScore(ModuleContract):
    module = DisparityScore
    instant = True


class TestLabelScore(ModuleContract):
    module = LabelScore
    instant = True


class TestShapeScore(ModuleContract):
    module = ShapeScore
    instant = True
