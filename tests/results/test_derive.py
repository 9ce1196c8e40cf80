"""Depth, disparity and normals follow from one of them and a camera; from nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Camera, DepthEvidence, DisparityEvidence
from visint.results.derive import derived

CAMERA = Camera(focal_length=100, cx=3.5, cy=2.5, baseline=50, width=8, height=6, doffs=10)


def flat(value, size=(6, 8)):
    return np.full(size, value, np.float32)


def test_depth_and_normals_follow_from_disparity():
    """Z = fB/(d + doffs) = 100·50/(40 + 10) = 100, and a fronto-parallel plane faces the camera."""
    found = derived({"match": ("Disparity", flat(40))}, CAMERA)
    assert set(found) == {"depth", "normals"}
    kind, depth, origin = found["depth"]
    assert (kind, origin) == ("Depth", "match")
    np.testing.assert_array_equal(depth, 100)
    np.testing.assert_allclose(found["normals"][1], np.broadcast_to([0, 0, -1], (6, 8, 3)), atol=1e-6)


def test_disparity_follows_from_depth():
    found = derived({"depth": ("Depth", flat(100))}, CAMERA)
    assert set(found) == {"disparity", "normals"}
    np.testing.assert_array_equal(found["disparity"][1], 40)


def test_evidence_stays_evidence_with_its_sigma():
    """σ_Z = Z² σ_d/(fB) = 100² · 0.5/5000 = 1, and back."""
    found = derived({"disparity": ("Disparity", DisparityEvidence.of(flat(40), 0.5, 0.25))}, CAMERA)
    depth = found["depth"][1]
    assert isinstance(depth, DepthEvidence)
    np.testing.assert_allclose(depth.sigma, 1, rtol=1e-6)
    np.testing.assert_array_equal(depth.reliability, 0.25)
    back = derived({"depth": ("Depth", depth)}, CAMERA)["disparity"][1]
    np.testing.assert_allclose(back.sigma, 0.5, rtol=1e-6)
    assert isinstance(found["normals"][1], np.ndarray)


def test_without_a_camera_nothing_follows():
    assert derived({"disparity": ("Disparity", flat(40))}, None) == {}


def test_from_maps_of_another_size_nothing_follows():
    """The camera is of 6 × 8 pixels: nobody knows where it saw a map of another size."""
    assert derived({"depth": ("Depth", flat(1, (3, 4)))}, CAMERA) == {}


@pytest.mark.parametrize("kind", ["Normals", "Relief", "Image"])
def test_what_has_no_scale_gives_no_depth(kind):
    assert derived({"map": (kind, flat(1))}, CAMERA) == {}


def test_what_the_graph_gives_is_left_alone():
    """A kind that is there is not derived again, under whatever name; nor is a name taken twice."""
    own = np.zeros((6, 8, 3), np.float32)
    found = derived({"surface": ("Depth", flat(100)), "facing": ("Normals", own)}, CAMERA)
    assert set(found) == {"disparity"}
    taken = derived({"depth": ("Disparity", flat(40))}, CAMERA)
    assert set(taken) == {"normals"}


def test_unknown_stays_unknown():
    disparity = flat(40)
    disparity[2, 3] = np.nan
    disparity[4, 1] = -10  # at infinity
    found = derived({"disparity": ("Disparity", disparity)}, CAMERA)
    assert np.argwhere(np.isnan(found["depth"][1])).tolist() == [[2, 3], [4, 1]]


def test_a_result_holds_what_was_derived_with_its_confidence(toys):
    """A white image is near: depth 1, reliability ½, so disparity = fB/1 − doffs and as sure."""
    camera = toys.camera((6, 8))
    result = toys.run(toys.CUE, image=np.ones((6, 8), np.float32), camera=camera)
    assert dict(result.kinds) == {"depth": "Depth", "disparity": "Disparity", "normals": "Normals"}
    np.testing.assert_allclose(result["disparity"], camera.focal_length * camera.baseline - camera.doffs)
    assert set(result.confidence) == {"depth", "disparity", "normals"}
    np.testing.assert_array_equal(result.confidence["normals"], 0.5)
    assert not result["disparity"].flags.writeable
    assert set(toys.run(toys.CUE, image=np.ones((6, 8), np.float32))) == {"depth"}
