"""``bayes.joint`` as a module, and the graph it is in."""

from __future__ import annotations

import numpy as np
import pytest

import visint
from visint.fields import DisparityEvidence
from visint.module import Context
from visint.testing import ModuleContract
from visint_bayes.joint.candidates import Candidates
from visint_bayes.joint.module import Joint, JointInputs
from visint_bayes.joint.surface import Surface
from visint_lab.datasets.pair import Pair
from visint_lab.metrics import depth_scores, shape_scores
from visint_lab.render.rendering import render
from visint_lab.scenes import scene


class TestJoint(ModuleContract):
    module = Joint


class TestCandidates(ModuleContract):
    module = Candidates


class TestSurface(ModuleContract):
    module = Surface


@pytest.fixture(scope="module")
def sphere():
    return render(scene("a/sphere/lambertian+2%", 96, 77), seed=77)


def reduction(found, stereo, pair):
    """Of squared errors of depth and of normals, %."""
    truth = pair.truth
    filled = Pair.of(pair).geometry(np.where(truth.foreground, stereo["disparity"], np.nan).astype(np.float32))
    before = depth_scores(filled[0], truth.depth)["mse"], shape_scores(filled[1], truth.normals)["s"]
    after = depth_scores(found["depth"], truth.depth)["mse"], shape_scores(found["normals"], truth.normals)["s"]
    return [100 * (1 - a / b) for a, b in zip(after, before, strict=True)]


def test_a_shaded_sphere_comes_out_better_than_its_stereo(sphere):
    """By half in squared depth and by more in squared normals, with the system's own masks."""
    given = {"left": sphere.left, "right": sphere.right, "camera": sphere.camera}
    stereo = visint.run(visint.load("stereo"), given)
    joint = visint.run(visint.load("joint"), {**given, "light": sphere.light})
    depth, shape = reduction(joint, stereo, sphere)
    assert depth > 40
    assert shape > 60
    sigma = joint["depth_sigma"][sphere.truth.foreground & joint["foreground"]]
    assert np.isfinite(sigma).all()
    assert (sigma > 0).all()


def test_it_needs_neither_light_nor_calibration(sphere):
    """A disparity map all the same, and a foreground."""
    found = visint.run(visint.load("joint"), {"left": sphere.left, "right": sphere.right})
    assert np.isfinite(found["disparity"]).all()
    assert found["foreground"].mean() == pytest.approx(sphere.truth.foreground.mean(), rel=0.15)


def test_without_a_void_the_last_cue_that_speaks_is_taken():
    """Planes where they speak, the matcher elsewhere, unchanged."""
    image = np.random.default_rng(0).random((40, 50)).astype(np.float32)
    matched = DisparityEvidence.of(np.full((40, 50), 4.0, np.float32), 0.5, 0.9)
    where = np.arange(50) > 25
    planes = DisparityEvidence.of(
        np.where(where, np.float32(5), np.nan) * np.ones((40, 1), np.float32), 0.2, 0.8
    )
    given = {"left": image, "right": image, "matched": matched.value, "depth": np.ones((40, 50), np.float32)}
    found = Joint().run(JointInputs(disparity_evidence=(matched, planes), **given), Context())
    assert found.foreground.all()
    assert found.depth == pytest.approx(np.where(where, 10.0, 12.5) * np.ones((40, 1)))
    assert not len(found.weights)


@pytest.mark.parametrize(("largest", "least"), [(60, 20), (30, -20)])
def test_images_of_any_size_are_solved_smaller_and_come_back_at_their_own(sphere, largest, least, monkeypatch):
    """One halving or two: the surface has the image's size; solved on a dozen pixels it is about the stereo."""
    monkeypatch.setattr("visint_bayes.joint.blend.LARGEST", largest)
    given = {"left": sphere.left, "right": sphere.right, "camera": sphere.camera}
    found = visint.run(visint.load("joint"), given | {"light": sphere.light})
    assert found["normals"].shape == (96, 96, 3)
    assert reduction(found, visint.run(visint.load("stereo"), given), sphere)[1] > least
