"""Eq. 4.7: one step of depth towards its neighbours' mean and shading's bending."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import ReliefEvidence
from visint.module import Context
from visint.testing import ModuleContract
from visint_bayes.pairwise import Pairwise, PairwiseInputs, PairwiseParams

ROWS, COLUMNS = np.mgrid[0:24, 0:32].astype(np.float32)
INNER = np.s_[1:-1, 1:-1]


class TestContract(ModuleContract):
    module = Pairwise


def step(depth, relief=None, *, boundaries=None, kinds=None, smoothing="everywhere", **params):
    flat = np.zeros(depth.shape) if relief is None else relief
    told = ReliefEvidence.of(flat.astype(np.float32), 1.0, 1.0)
    given = PairwiseInputs(depth=depth.astype(np.float32), relief=told, boundaries=boundaries, kinds=kinds)
    return Pairwise(PairwiseParams(smoothing=smoothing, **params)).run(given, Context()).depth


def test_the_correction_is_alpha_times_the_relief_s_quarter_laplacian():
    """Depth 50 + c x², relief −k x²: Δ is c/2 and −k/2, of opposite signs, so D' = D + c/2 + α k/2 inside."""
    depth, relief = 50 + 0.02 * COLUMNS**2, -0.3 * COLUMNS**2
    found = step(depth, relief, alpha=0.05)
    assert found[INNER] == pytest.approx((depth + 0.01 + 0.05 * 0.15)[INNER], abs=1e-4)


def test_where_both_bend_alike_the_mean_alone_is_taken():
    """Relief and depth of one sign: the step is the neighbours' mean, whatever α."""
    depth = 50 + 0.02 * COLUMNS**2
    assert np.array_equal(step(depth, 0.3 * COLUMNS**2, alpha=0.05), step(depth, None))


def test_alpha_zero_is_the_mean_whatever_the_relief():
    """The control keeps the smoothing and nothing of shading."""
    rng = np.random.default_rng(1)
    depth = 50 + rng.normal(0, 1, ROWS.shape)
    assert np.array_equal(step(depth, rng.normal(0, 9, ROWS.shape), alpha=0.0), step(depth))


def test_smoothing_against_touches_only_what_bends_the_other_way():
    """With ``smoothing: against`` a depth that bends as the relief does stays as it is."""
    depth = 50 + 0.02 * COLUMNS**2
    assert np.array_equal(
        step(depth, 0.3 * COLUMNS**2, smoothing="against")[INNER], depth.astype(np.float32)[INNER]
    )


def test_without_relief_there_is_no_step():
    """On levels where shading is not asked the matcher's depth goes through."""
    depth = (50 + 0.02 * COLUMNS**2).astype(np.float32)
    assert np.array_equal(Pairwise().run(PairwiseInputs(depth=depth), Context()).depth, depth)


def test_a_plane_stays_a_plane():
    """The mean of opposite neighbours on a plane is the plane, at the frame too."""
    depth = 50 + 0.1 * COLUMNS - 0.2 * ROWS
    assert step(depth) == pytest.approx(depth, abs=1e-4)


def test_nothing_crosses_a_boundary():
    """Two flat halves, a line of boundary between: neither learns of the other, the boundary keeps its own."""
    wall = COLUMNS == 15
    depth = np.where(COLUMNS > 15, 60.0, 50.0)
    depth[:, 15] = 60.0
    assert np.array_equal(step(depth, boundaries=wall), depth.astype(np.float32))


@pytest.mark.parametrize(("kind", "held"), [(1, False), (2, False), (3, True), (4, True), (5, True)])
def test_boundaries_keep_stereo_s_depth_at_creases_and_marks_but_not_at_limbs(kind, held):
    """At limbs and occluding edges the boundary's depth is its own side's."""
    wall = COLUMNS == 15
    depth = np.where(wall, 57.0, 50.0)
    kinds = np.where(wall, kind, 0).astype(np.uint8)
    found = step(depth, boundaries=wall, kinds=kinds)
    assert found[:, 15] == pytest.approx(57.0 if held else 50.0)


def test_unknown_depth_stays_unknown_and_spreads_nowhere():
    """NaN neighbours do not count; a NaN pixel stays NaN."""
    depth = np.full((9, 9), 50.0)
    depth[4, 4] = np.nan
    found = step(depth)
    assert np.isnan(found[4, 4])
    assert found[~np.isnan(depth)] == pytest.approx(50.0)


def test_repeated_without_stereo_the_surface_flattens():
    """Eq. 4.7 has no data term (errata): its fixed point inside a frame is flat, so it belongs into a loop."""
    depth = 50 + 0.02 * (COLUMNS - 16) ** 2
    after = depth
    for _ in range(1500):
        after = step(after)
    assert np.ptp(after) < 0.2 * np.ptp(depth)
