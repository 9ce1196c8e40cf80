"""Without a void nothing is claimed beyond the evidence: its disparity and its reliability go through."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Camera, DisparityEvidence
from visint.module import Context
from visint_bayes.joint.module import Joint, JointInputs
from visint_bayes.joint.photographs import preferred

SIZE = (12, 16)
CAMERA = Camera(focal_length=100.0, cx=8.0, cy=6.0, baseline=1.0, doffs=0.0, width=16, height=12)


def said(value, reliability, sigma=0.5):
    return DisparityEvidence.of(np.full(SIZE, value, np.float32), sigma, reliability)


def test_the_last_cue_that_speaks_is_taken():
    """A cue that abstains leaves the word to the one before it."""
    silent = np.where(np.arange(16) < 8, 0.0, 0.9) * np.ones(SIZE)
    value, sigma, trust = preferred([said(4.0, 0.6), said(5.0, silent, sigma=0.25)])
    assert (value[:, :8] == 4).all()
    assert (value[:, 8:] == 5).all()
    assert sigma[0, [0, 15]] == pytest.approx([0.5, 0.25])
    assert trust[0, [0, 15]] == pytest.approx([0.6, 0.9])


def test_where_nobody_speaks_nothing_is_known():
    """NaN, and no reliability."""
    value, _, trust = preferred([said(4.0, 0.0)])
    assert np.isnan(value).all()
    assert (trust == 0).all()


def test_the_reliability_of_the_evidence_is_the_confidence():
    """It is calibrated as a chance of being right; sigma would order pixels by sharpness instead."""
    trust = np.linspace(0.1, 1, 16, dtype=np.float32) * np.ones(SIZE, np.float32)
    found = Joint().run(
        JointInputs(
            depth=np.full(SIZE, 30.0, np.float32), camera=CAMERA, disparity_evidence=(said(4.0, trust),)
        ),
        Context(),
    )
    assert np.array_equal(found.depth_confidence, trust)
    assert found.depth == pytest.approx(25.0)
