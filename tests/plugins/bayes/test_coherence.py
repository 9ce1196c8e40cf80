"""Coherence: the truth table of Eqs. 5.31 and 5.52, its medians, its boundaries, and three modules of it."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from visint.fields import Camera, DepthEvidence, DisparityEvidence, NormalsEvidence, ReliefEvidence
from visint.fields.geometry import depth_from_disparity, normals_from_depth
from visint.module import Context
from visint.testing import ModuleContract
from visint_bayes.coherence.disparity import (
    CohereDepth,
    CohereDepthInputs,
    CohereDisparity,
    CohereDisparityInputs,
    CohereDisparityParams,
)
from visint_bayes.coherence.orientation import CohereNormals, CohereNormalsInputs
from visint_bayes.coherence.table import AGREED, ALONE, REJECTED, REPLACED, Opinions, validated


class TestDisparity(ModuleContract):
    module = CohereDisparity


class TestDepth(ModuleContract):
    module = CohereDepth


class TestNormals(ModuleContract):
    module = CohereNormals


def judged(around, known, limit=1.0, own=7.0, neighbours=4, lines=None):
    """The verdict on the middle of 3 × 3 pixels, whose neighbours, from above on, say ``around``."""
    predicted = np.full((3, 3), np.nan, np.float32)
    places = [(0, 1), (1, 2), (2, 1), (1, 0), (0, 0), (0, 2), (2, 2), (2, 0)]
    for place, value in zip(places, around, strict=False):
        predicted[place] = value
    mine = np.full((3, 3), own, np.float32)
    fields = (each[..., None] for each in (predicted, mine, np.full_like(mine, known)))
    found = validated(Opinions(*fields, np.ones_like(mine), np.ones_like(mine)), lines, neighbours, limit)
    return found.value[1, 1, 0], found.row[1, 1], found


@pytest.mark.parametrize(
    ("around", "known", "value", "row"),
    [
        ((0, 0, 4, 4), 9, 9, REJECTED),  # var(F) = 4 > 1: the map's value
        ((1, 1.5, 2, 2.5), 2.2, 2.0, AGREED),  # var of all 0.28: the median of the five
        ((1, 1.5, 2, 2.5), 9, 1.75, REPLACED),  # var(F) = 0.31, with 9 among them 8.5: the median of the four
        ((1, 2, np.nan, np.nan), 1.8, 1.8, AGREED),
        ((1, 1.2, 1.6, np.nan), 5, 1.2, REPLACED),
        ((1, 2, 1, 2), np.nan, 1.5, REPLACED),  # the map knows nothing
        ((3, np.nan, np.nan, np.nan), 5, 7, ALONE),  # one neighbour agrees with itself: the cue's own
        ((np.nan,) * 4, 5, 7, ALONE),
    ],
)
def test_the_truth_table(around, known, value, row):
    """Keeps, takes the median of all, replaces: by var(F) and var(F with the map's value) against ρ."""
    found, which, verdict = judged(around, known)
    assert np.isclose(found, value)
    assert which == row
    assert (verdict.beta[1, 1] < 0.5) == (row == REJECTED)
    if row in (AGREED, REPLACED) and np.isfinite(known):
        assert (verdict.kappa[1, 1] >= 0.5) == (row == AGREED)


def test_the_threshold_belongs_to_agreement():
    """var(F) = ρ exactly is no disagreement: β is ½."""
    found, row, verdict = judged((0, 2, 0, 2), 1.0)
    assert row == AGREED
    assert found == 1.0
    assert verdict.beta[1, 1] == 0.5


@pytest.mark.parametrize("neighbours", [4, 8])
def test_medians_are_those_of_numpy(neighbours):
    """Of any number of values, with ties, with and without the map's."""
    random = np.random.default_rng(3)
    for known, _ in product((np.nan, 4.0), range(60)):
        around = random.integers(0, 9, neighbours).astype(float)
        around[random.random(neighbours) < 0.3] = np.nan
        members = around[np.isfinite(around)]
        if len(members) < 2:
            continue
        found, row, _ = judged(around, known, limit=100.0, neighbours=neighbours)
        everybody = members if np.isnan(known) else [*members, known]
        assert row == (REPLACED if np.isnan(known) else AGREED)
        assert np.isclose(found, np.median(everybody))


def test_the_median_of_vectors_is_a_member():
    """The nearest to the medians of the components, never a mixture of two."""
    random = np.random.default_rng(5)
    vectors = random.normal(size=(3, 3, 3)).astype(np.float32)
    vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
    nothing, one = np.full_like(vectors, np.nan), np.ones((3, 3), np.float32)
    found = validated(Opinions(vectors, vectors, nothing, one, one), None, 8, 9.0)
    members = np.delete(vectors.reshape(9, 3), 4, axis=0)
    nearest = members[np.linalg.norm(members - np.median(members, axis=0), axis=1).argmin()]
    assert np.array_equal(found.value[1, 1], nearest)


def test_nobody_is_asked_across_a_boundary():
    """A step of 10 px along a line of boundary pixels: both sides stay as they are, without it they do not."""
    step = np.where(np.arange(9) < 5, 0, 10).astype(np.float32) * np.ones((7, 1), np.float32)
    line = np.zeros(step.shape, bool)
    line[:, 4] = True
    evidence = DisparityEvidence.of(step, 0.2, 0.9)
    given = {"evidence": evidence, "disparity": np.full_like(step, 3)}
    params = CohereDisparityParams(rho=4.0)
    apart = CohereDisparity(params).run(CohereDisparityInputs(**given, boundaries=line), Context()).evidence
    assert np.array_equal(apart.value, step)
    assert np.allclose(apart.reliability[:, 6:], 0.9)
    mixed = CohereDisparity(params).run(CohereDisparityInputs(**given), Context())
    assert (mixed.evidence.value[1:-1, 4:6] == 3).all()
    assert (mixed.evidence.reliability[1:-1, 4:6] < 0.45).all()
    assert (mixed.beta[1:-1, 4:6] < 0.5).all()


def test_matches_that_lead_back_agree():
    """Both views have disparity 3: neighbours predict 3, as reliable as they were; an outlier is replaced."""
    field = np.full((8, 16), 3, np.float32)
    wrong = field.copy()
    wrong[4, 10] = 9
    given = {"evidence": DisparityEvidence.of(wrong, 0.1, 0.8), "back": field, "disparity": field}
    found = CohereDisparity().run(CohereDisparityInputs(**given), Context())
    assert (found.evidence.value[:, 5:] == 3).all()
    assert found.beta[4, 10] == 1
    assert np.isclose(found.evidence.reliability[4, 10], 0.8 / (1 + 6**2 / 4))  # they lead back six pixels off
    same = found.evidence.reliability[1:-1, 5:-1].copy()
    same[3, 5] = 0.8
    assert np.allclose(same, 0.8)


def test_where_the_other_view_disagrees_the_map_stands():
    """The right view says 3 here and 13 there: neighbours' matches lead to both, and the map's 5 is kept."""
    random = np.random.default_rng(1)
    field = np.full((12, 40), 3, np.float32)
    back = np.where(random.random(field.shape) < 0.5, 3, 13).astype(np.float32)
    given = {
        "evidence": DisparityEvidence.of(field, 0.1, 0.8),
        "back": back,
        "disparity": np.full_like(field, 5),
    }
    found = CohereDisparity().run(CohereDisparityInputs(**given), Context())
    assert (found.evidence.value[found.beta < 0.5] == 5).all()
    assert (found.beta < 0.5)[2:-2, 8:-2].mean() > 0.6


def test_depth_is_validated_as_disparity():
    """The same numbers in depth: value and verdict agree with those of the disparity."""
    camera = Camera(focal_length=100, cx=8, cy=4, baseline=1, width=16, height=9)
    random = np.random.default_rng(2)
    field = (5 + random.normal(0, 0.8, camera.size)).astype(np.float32)
    known = np.full(camera.size, 5, np.float32)
    plain = CohereDisparityInputs(evidence=DisparityEvidence.of(field, 0.3, 0.7), disparity=known)
    wanted = CohereDisparity().run(plain, Context())
    depth, before = (depth_from_disparity(each, camera) for each in (field, known))
    evidence = DepthEvidence.of(depth, depth**2 * 0.3 / 100, 0.7)
    found = CohereDepth().run(CohereDepthInputs(evidence=evidence, depth=before, camera=camera), Context())
    assert np.allclose(found.evidence.value, depth_from_disparity(wanted.evidence.value, camera), rtol=1e-4)
    assert np.allclose(found.beta, wanted.beta, atol=1e-4)


def test_relief_speaks_through_its_orientations():
    """The relief of a slanted plane, off by a constant, has the plane's own normals."""
    camera = Camera(focal_length=100, cx=10, cy=8, baseline=1, width=21, height=17)
    across = np.arange(21, dtype=np.float32) - 10
    depth = (50 / (1 - 0.004 * across)) * np.ones((17, 1), np.float32)
    given = {
        "relief_evidence": ReliefEvidence.of(depth.astype(np.float32), 0.1, 0.6),
        "depth": depth.astype(np.float32),
    }
    found = CohereNormals().run(CohereNormalsInputs(**given, camera=camera), Context()).evidence
    assert np.allclose(found.value, normals_from_depth(depth.astype(np.float32), camera), atol=0.02)
    assert np.allclose(found.reliability, 0.6, atol=0.01)


def test_noisy_normals_leave_the_map_its_own():
    """Random directions vary by a third a component: above 0.2 the map's normal comes back, hardly believed."""
    random = np.random.default_rng(4)
    noisy = random.normal(size=(20, 20, 3)).astype(np.float32)
    noisy /= np.linalg.norm(noisy, axis=-1, keepdims=True)
    front = np.broadcast_to(np.float32([0, 0, -1]), noisy.shape)
    given = {
        "normals_evidence": NormalsEvidence.of(noisy, 0.1, 1.0),
        "normals": front,
        "depth": np.ones((20, 20), np.float32),
    }
    found = CohereNormals().run(CohereNormalsInputs(**given), Context())
    rejected = found.beta < 0.5
    assert rejected[1:-1, 1:-1].mean() > 0.9
    assert np.array_equal(found.evidence.value[rejected], front[rejected])
