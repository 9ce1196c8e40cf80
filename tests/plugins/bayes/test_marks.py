"""Lines that a sure map crosses smoothly are marks; steps, creases and doubt keep them."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import BoundariesEvidence
from visint.module import Context
from visint.testing import ModuleContract
from visint_bayes.coherence.boundaries import CohereBoundaries, CohereBoundariesInputs


class TestContract(ModuleContract):
    module = CohereBoundaries


ACROSS = np.arange(31, dtype=np.float32) * np.ones((24, 1), np.float32)
SURFACES = {
    "plane": 0.2 * ACROSS,
    "bowl": 0.002 * (ACROSS - 15) ** 2,
    "step": 0.2 * ACROSS + np.where(ACROSS > 15, 2, 0),
    "crease": 0.3 * np.abs(ACROSS - 15),
}


def judged(disparity, sure=0.9, line=15):
    said = np.zeros(disparity.shape, bool)
    said[:, line] = True
    given = {
        "disparity": disparity.astype(np.float32),
        "depth_confidence": np.full(said.shape, sure, np.float32),
    }
    return CohereBoundaries().run(
        CohereBoundariesInputs(evidence=BoundariesEvidence.of(said, 1.0, 0.8), **given), Context()
    )


@pytest.mark.parametrize(("surface", "kept"), [("plane", 0), ("bowl", 0), ("step", 24), ("crease", 24)])
def test_what_the_surface_does_at_a_line_decides(surface, kept):
    found = judged(SURFACES[surface])
    assert found.evidence.value.sum() == kept
    assert found.marks.sum() == 24 - kept


def test_noise_is_averaged_along_the_line():
    """A third of a pixel of noise makes no step of a plane, along 24 pixels of border, and hides none."""
    random = np.random.default_rng(0)
    noise = random.normal(0, 0.3, ACROSS.shape)
    assert not judged(SURFACES["plane"] + noise).evidence.value.any()
    assert judged(SURFACES["step"] + noise).evidence.value.sum() == 24


def test_a_map_that_is_not_sure_takes_nothing_back():
    """At a third, and where it knows nothing at all."""
    assert judged(SURFACES["plane"], sure=0.3).evidence.value.sum() == 24
    assert judged(np.full(ACROSS.shape, np.nan)).evidence.value.sum() == 24


def test_each_border_is_judged_by_itself():
    """Three stripes on a plane that jumps between the last two: the first line goes, the second stays."""
    said = np.zeros(ACROSS.shape, bool)
    said[:, (10, 20)] = True
    disparity = np.where(ACROSS > 20, 3, 0).astype(np.float32)
    given = {"disparity": disparity, "depth_confidence": np.full(said.shape, 0.9, np.float32)}
    evidence = BoundariesEvidence.of(said, 1.0, 0.8)
    found = CohereBoundaries().run(CohereBoundariesInputs(evidence=evidence, **given), Context()).evidence
    assert not found.value[:, 10].any()
    assert found.value[:, 20].all()
    assert (found.reliability[:, 10] >= 0.8).all()
