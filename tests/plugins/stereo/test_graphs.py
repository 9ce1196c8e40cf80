"""The two stereo graphs, run as anybody runs them."""

from __future__ import annotations

import numpy as np
import pytest

import visint


@pytest.mark.parametrize("name", ["stereo", "stereo_sgm"])
def test_a_graph_recovers_a_shift_and_what_follows_from_it(shifted, name):
    """Disparity to 0.05 px, and with a camera depth and normals of the fronto-parallel plane it means."""
    left, right = shifted(6.3)
    camera = visint.Camera(
        focal_length=200, cx=80, cy=48, baseline=2, width=160, height=96, disparity_range=(0, 16)
    )
    result = visint.run(name, left=left, right=right, camera=camera)
    inside = np.s_[8:-8, 24:-8]
    assert np.percentile(np.abs(result["disparity"][inside] - 6.3), 99) < 0.05
    assert np.isclose(np.median(result["depth"][inside]), 200 * 2 / 6.3, rtol=0.01)
    assert np.median(result["normals"][inside][..., 2]) < -0.95


def test_the_baseline_needs_no_range(shifted):
    """Coarse to fine finds 40 px of 160 columns, and no camera is needed."""
    found = visint.run("stereo", left=shifted(40.2)[0], right=shifted(40.2)[1])["disparity"]
    assert np.percentile(np.abs(found[8:-8, 50:-8] - 40.2), 99) < 0.1


@pytest.mark.parametrize("name", ["stereo", "stereo_sgm"])
def test_a_black_pair_is_no_surface(name):
    """Nothing to see: a map without a single value."""
    black = np.zeros((40, 60), np.float32)
    assert np.isnan(visint.run(name, left=black, right=black)["disparity"]).all()
