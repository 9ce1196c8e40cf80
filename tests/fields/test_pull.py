"""How far a map moved towards what a cue said: in depth, disparity, normals, slopes, relief and boundaries."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import (
    KINDS,
    BoundariesEvidence,
    DepthEvidence,
    DisparityEvidence,
    IncidenceEvidence,
    NormalsEvidence,
    ReliefEvidence,
    SlopesEvidence,
    geometry,
)
from visint.fields.pull import pull
from visint.fields.snapshot import MapSnapshot, Writer
from visint.testing.samples import sample_camera

SIZE = (9, 11)
CAMERA = sample_camera(SIZE)
WRITER = Writer("cue", 0, 0)


def snapshot(depth, confidence=0.0, **others):
    kinds = {"depth": KINDS["Depth"], "boundaries": KINDS["Boundaries"]}
    values = {"depth": depth, "boundaries": None, **others}
    sure = {"depth": np.full(SIZE, confidence, np.float32), "boundaries": None}
    return MapSnapshot(CAMERA, kinds, values, sure)


def flat(value):
    return np.full(SIZE, value, np.float32)


def slanted(across, down=0.0):
    """Depth 500 at the first pixel, rising by so much a column and a row."""
    y, x = np.mgrid[: SIZE[0], : SIZE[1]].astype(np.float32)
    return (500 + across * x + down * y).astype(np.float32)


def test_the_share_of_the_way():
    """From 500 to 530 where 600 was said: 0.3. Away from it, or past it: 0 and 1."""
    said = DepthEvidence.of(flat(600), 1.0, 1.0)
    for now, share in ((530, 0.3), (480, 0), (620, 1), (500, 0)):
        found = pull(snapshot(flat(500)), snapshot(flat(now)), "depth", said)
        np.testing.assert_allclose(found, share, rtol=1e-5)
        assert found.dtype == np.float32


def test_disparity_is_seen_as_disparity():
    """A map that moves halfway in disparity has moved by another share in depth."""
    before, goal = flat(8), flat(4)
    half = geometry.depth_from_disparity(flat(6), CAMERA)
    old = geometry.depth_from_disparity(before, CAMERA)
    found = pull(snapshot(old), snapshot(half), "depth", DisparityEvidence.of(goal, 0.1, 1.0))
    np.testing.assert_allclose(found, 0.5, rtol=1e-4)


def test_who_abstains_and_who_agrees_pulls_nothing():
    value = flat(600)
    value[0] = np.nan
    value[1] = 500.04
    found = pull(snapshot(flat(500)), snapshot(flat(550)), "depth", DepthEvidence.of(value, 1.0, 1.0))
    np.testing.assert_array_equal(found[:2], 0)
    np.testing.assert_allclose(found[2:], 0.5)


def test_what_was_unknown_is_found_whole():
    before = flat(500)
    before[3:] = np.nan
    after = flat(500)
    after[5:] = np.nan
    found = pull(snapshot(before), snapshot(after), "depth", DepthEvidence.of(flat(500), 1.0, 1.0))
    assert found[:, 0].tolist() == [0, 0, 0, 1, 1, 0, 0, 0, 0]


@pytest.mark.parametrize("kind", ["slopes", "normals", "relief"])
def test_shape_is_compared_as_shape(kind):
    """A plane that tilts halfway to what was said; relief is so at any scale."""
    goal = slanted(4.0)
    said = {
        "slopes": lambda: SlopesEvidence.of(geometry.slopes_from_depth(goal), 0.01, 1.0),
        "normals": lambda: NormalsEvidence.of(geometry.normals_from_depth(goal, CAMERA), 0.001, 1.0),
        "relief": lambda: ReliefEvidence.of(slanted(0.0, 2.0) - 500, 0.001, 1.0),
    }[kind]()
    old, new = (slanted(1.0, 1.0), slanted(0.5, 1.0)) if kind == "relief" else (slanted(2.0), slanted(3.0))
    found = pull(snapshot(old), snapshot(new), "depth", said)[2:-2, 2:-2]
    np.testing.assert_allclose(found, 0.5, atol=0.03)


def test_boundaries_are_there_or_not():
    """1 where a pixel became what was said, 0 where it was so before or still is not."""
    before, after, goal = (np.zeros(SIZE, bool) for _ in range(3))
    goal[2], after[2, :5] = True, True
    said = BoundariesEvidence.of(goal, 1.0, 1.0)
    found = pull(
        snapshot(flat(500), boundaries=before), snapshot(flat(500), boundaries=after), "boundaries", said
    )
    assert found[2].tolist() == [1] * 5 + [0] * 6
    assert not found[:2].any()
    first = pull(snapshot(flat(500)), snapshot(flat(500), boundaries=after), "boundaries", said)
    np.testing.assert_array_equal(first, 1)


def test_what_cannot_be_compared_counts_by_what_the_map_gained():
    """Incidence says no depth: the rise of the confidence, from ½ to ¾ half of what was left."""
    said = IncidenceEvidence.of(flat(0.8), 0.1, 1.0)
    found = pull(snapshot(flat(500), 0.5), snapshot(flat(510), 0.75), "depth", said)
    np.testing.assert_allclose(found, 0.5)
