"""Semi-global matching along a prior: it decides where the views say nothing, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import DisparityEvidence
from visint.module import Context
from visint_stereo.semiglobal.match import Settings
from visint_stereo.semiglobal.resolution import matched_within
from visint_stereo.semiglobal.search_range import within
from visint_stereo.semiglobal.volume import Penalties, Prior, path_costs
from visint_stereo.sgm import SemiGlobal, SemiGlobalInputs, SemiGlobalParams

INSIDE = np.s_[8:-8, 40:-8]


def match(left, right, prior=None):
    module = SemiGlobal(SemiGlobalParams(min_disparity=0, max_disparity=32))
    return module.run(SemiGlobalInputs(left=left, right=right, prior=prior), Context(size=left.shape))


def surface(value, weight, shape=(96, 160)):
    return DisparityEvidence.of(np.broadcast_to(np.float32(value), shape).astype(np.float32), 1.0, weight)


def test_a_prior_that_is_silent_changes_nothing(shifted):
    """Reliability 0 everywhere is no prior: the same bits."""
    views = shifted(11.3)
    silent = surface(5, 0.0)
    assert np.array_equal(match(*views).disparity.value, match(*views, silent).disparity.value, equal_nan=True)


def test_texture_overrules_a_wrong_prior(shifted):
    """A full-weight prior 8 px off does not move what both views show."""
    found = match(*shifted(11.3), surface(3, 1.0)).disparity.value[INSIDE]
    assert np.percentile(np.abs(found - 11.3), 99) < 0.1


def test_where_nothing_is_seen_the_prior_decides(shifted):
    """An even patch between textures of another depth takes the prior's disparity, and nothing else does."""
    left, right = (view.copy() for view in shifted(6.0))
    left[30:66, 60:130] = right[30:66, 40:130] = 0.5
    patch = np.s_[40:56, 80:110]
    value = np.full(left.shape, 6, np.float32)
    value[30:66, 60:130] = 9
    weight = np.zeros(left.shape)
    weight[30:66, 60:130] = 1
    found = match(left, right, DisparityEvidence.of(value, 1.0, weight)).disparity.value
    assert np.abs(found[patch] - 9).max() < 1.1
    assert np.median(np.abs(found[74:88, 40:-8] - 6)) < 0.05


def test_paths_climb_with_a_slanted_prior():
    """Costs that are 0 along a slant and 20 elsewhere sum to 0 along it; without it each step has a price."""
    rows, columns, depth = 12, 24, 32
    y, x = np.mgrid[:rows, :columns]
    slant = (x + 2).astype(np.float32)
    cost = np.full((rows, columns, depth), 20, np.uint8)
    cost[y, x, x + 2] = 0
    grades = np.zeros((rows, columns), np.uint16)
    levels = within(0, depth - 1, 64)
    prior = Prior.of(slant, np.ones_like(slant))
    sums = [path_costs(cost, levels, grades, Penalties(), lambda: None, given) for given in (None, prior)]
    on = [total[y, x, x + 2] for total in sums]
    assert not on[1].any()
    assert on[0][4:-4, 4:-4].min() > 0


def test_the_right_view_is_told(shifted):
    """``right_disparity`` is the shift in the interior, and unknown for a pair that shows nothing."""
    found = match(*shifted(23.0)).right_disparity
    assert np.abs(found[8:-8, 8:-40] - 23).max() <= 1
    even = np.full((40, 60), 0.5, np.float32)
    assert np.isnan(match(even, even).right_disparity).all()


@pytest.mark.parametrize("cells", [10_000])
def test_a_prior_is_followed_at_two_resolutions(shifted, cells):
    """The large-pair path takes the prior along: an even patch takes its value there too."""
    left, right = (view.copy() for view in shifted(6.0))
    left[30:66, 60:130] = right[30:66, 40:130] = 0.5
    value = np.full(left.shape, np.nan, np.float32)
    value[30:66, 60:130] = 9
    prior = Prior.of(value, np.isfinite(value).astype(np.float32))
    levels = within(0, 40, 160)
    found = matched_within(left, right, levels, Settings(), lambda: None, cells, prior=prior).disparity
    assert np.abs(found[40:56, 80:110] - 9).max() < 1.1
