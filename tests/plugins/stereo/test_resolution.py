"""Large pairs at two resolutions: the same answers, seams and all."""

from __future__ import annotations

import numpy as np
import pytest

from visint_stereo.semiglobal import resolution
from visint_stereo.semiglobal.match import Settings
from visint_stereo.semiglobal.resolution import matched_within
from visint_stereo.semiglobal.search_range import within


def test_a_shift_is_recovered_from_half_the_size(shifted):
    """Forced to two resolutions, a shift comes back as it does at one."""
    left, right = shifted(23.4)
    match = matched_within(left, right, within(0, 40, 160), Settings(), lambda: None, cells=10_000)
    off = np.abs(match.disparity[8:-8, 40:-8] - 23.4)
    assert np.percentile(off, 99) < 0.1
    assert match.trust[8:-8, 40:-8].mean() > 0.8


def test_strips_join_without_a_seam(shifted, monkeypatch):
    """Matched in strips of few rows, the map differs hardly from that of one strip."""
    left, right = (np.tile(view, (2, 1)) for view in shifted(9.7))
    levels = within(0, 40, 160)
    whole = matched_within(left, right, levels, Settings(), lambda: None, cells=10_000)
    monkeypatch.setattr(resolution, "STRIP", 4 * 24 * 160)
    strips = matched_within(left, right, levels, Settings(), lambda: None, cells=10_000)
    assert strips.disparity.shape == whole.disparity.shape
    assert np.mean(np.abs(strips.disparity - whole.disparity) > 0.05) < 0.02


@pytest.mark.parametrize("scene", ["mb2003/teddy"])
def test_a_real_pair_hardly_suffers(real_pair, filled, bad, scene):
    """At most a fifth more wrong pixels than at one resolution, though the pair is far too small for it."""
    pair = real_pair(scene)
    levels = within(0, pair.levels, pair.left.shape[1])
    views = (pair.left, pair.right, levels, Settings(), lambda: None)
    one, two = matched_within(*views), matched_within(*views, cells=4_000_000)
    assert bad(filled(two.disparity), pair.truth) < 1.2 * bad(filled(one.disparity), pair.truth)
