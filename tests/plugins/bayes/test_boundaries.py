"""Eq. 5.25: boundaries of the map and of the evidence drawn together."""

from __future__ import annotations

import cv2
import numpy as np

from visint.fields import BoundariesEvidence
from visint.module import Context
from visint.testing import ModuleContract
from visint_bayes.boundaries import Boundaries, BoundariesInputs, BoundariesParams


class TestContract(ModuleContract):
    module = Boundaries


def lines(*drawn, shape=(40, 40)):
    """Lines (row, column, row, column), one pixel wide."""
    field = np.zeros(shape, np.uint8)
    for r0, c0, r1, c1 in drawn:
        cv2.line(field, (c0, r0), (c1, r1), 1)
    return field > 0


def together(said, trust, before=None, sure=None, **params):
    evidence = BoundariesEvidence.of(said, 1.0, trust)
    given = {"evidence": evidence, "boundaries": before}
    if sure is not None:
        given["boundaries_confidence"] = np.full(said.shape, sure, np.float32)
    return Boundaries(BoundariesParams(**params)).run(BoundariesInputs(**given), Context())


def test_two_lines_meet_at_the_weighted_mean():
    """Weights ¾ at row 20 and ¼ at row 18: (¾·20 + ¼·18)/1 = 19.5, rounded up to 20; swapped, 18.5, to 19."""
    near, far = lines((20, 0, 20, 39)), lines((18, 0, 18, 39))
    found = together(near, np.where(near, 0.75, 0.0), far, 0.25, keep=0.0).boundaries
    assert found[20, 5:35].all()
    assert not found[18:20, 5:35].any()
    found = together(near, np.where(near, 0.25, 0.0), far, 0.75, keep=0.0).boundaries
    assert found[19, 5:35].all()
    assert not found[20, 5:35].any()


def test_lines_out_of_reach_stay_apart():
    """Three pixels and a reach of two: each stays where it is."""
    found = together(lines((20, 0, 20, 39)), 0.5, lines((23, 0, 23, 39)), 0.9, keep=0.0).boundaries
    assert found[20, 5:35].all()
    assert found[23, 5:35].all()


def test_what_was_closed_stays_closed():
    """A digital circle and a shifted one: inside and outside stay apart, whatever the rounding."""
    for radius in (5, 8, 12.5, 15):
        y, x = np.mgrid[:40, :40]
        inside = np.hypot(y - 19.6, x - 20.2) < radius
        ring = inside & ~cv2.erode(inside.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
        found = together(ring, 0.7, np.roll(ring, 1, 1), 0.4, keep=0.0).boundaries
        _, labels = cv2.connectedComponents((~found).astype(np.uint8), connectivity=4)
        assert labels[0, 0] != labels[20, 20]


def test_the_map_forgets_what_is_denied():
    """A boundary of the map where the evidence is sure that there is none goes; unheard of, it stays."""
    before = lines((20, 0, 20, 39))
    nothing = np.zeros_like(before)
    assert not together(nothing, 0.9, before, 0.8).boundaries.any()
    assert together(nothing, 0.0, before, 0.8).boundaries[20].sum() > 30
    assert together(nothing, 0.9, before, 0.8, keep=0.0).boundaries.any()


def test_an_empty_map_takes_the_evidence():
    """Without a map each line stays, its confidence the coherence of what was said, but for its ends."""
    said = lines((20, 10, 20, 30))
    found = together(said, np.where(said, 0.75, 0.9))
    assert (found.boundaries[20, 12:29]).all()
    assert not found.boundaries[19].any()
    assert np.allclose(found.boundaries_confidence[20, 12:29], 0.75)
    assert np.allclose(found.boundaries_confidence[5], 0.9)
