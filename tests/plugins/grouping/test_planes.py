"""Planes of regions: known answers from scenes made of planes, and abstention where there are none."""

from __future__ import annotations

import numpy as np
import pytest

import visint
from visint.fields import DisparityEvidence
from visint.module import Context
from visint_grouping.planes.guide import Guide
from visint_grouping.planes.mend import Mend, MendInputs
from visint_grouping.planes.region_planes import RegionPlanes, RegionPlanesInputs, RegionPlanesParams

HERE = Context()
SHAPE = (60, 90)


def plane(a, b, c, shape=SHAPE):
    y, x = np.mgrid[: shape[0], : shape[1]]
    return (a * x + b * y + c).astype(np.float32)


def halves(shape=SHAPE):
    """Two regions side by side, and an image that shows them."""
    regions = np.ones(shape, np.int32)
    regions[:, shape[1] // 2 :] = 2
    return regions, (0.2 + 0.5 * (regions == 2)).astype(np.float32)


def planes_of(value, regions, image, hole=None, *, right_disparity=None, right=None, **params):
    """``hole``: pixels without a vote; their values are nonsense."""
    hole = np.zeros(value.shape, bool) if hole is None else hole
    given = np.where(hole, np.float32(40), value)
    evidence = DisparityEvidence.of(given, 0.2, np.where(hole, 0.1, 0.95))
    inputs = RegionPlanesInputs(
        left=image,
        evidence=evidence,
        consistent=~hole,
        regions=regions,
        right=right,
        right_disparity=right_disparity,
    )
    return RegionPlanes(RegionPlanesParams(**params)).run(inputs, HERE)


def test_planes_are_exact_and_fill_holes():
    """Each half has a slanted plane and a hole of a third: the planes come back to 0.01 px, holes and all."""
    regions, image = halves()
    truth = np.where(regions == 1, plane(0.05, -0.1, 12), plane(-0.2, 0.05, 45))
    hole = np.zeros(SHAPE, bool)
    hole[20:40] = True
    found = planes_of(truth, regions, image, hole).disparity
    assert np.abs(found.value - truth).max() < 0.01
    assert found.reliability.min() > 0.25


def test_outliers_do_not_bend_a_plane():
    """A third of the votes lie anywhere; the plane does not notice."""
    regions, image = halves()
    truth = plane(0.1, 0.05, 10)
    rng = np.random.default_rng(1)
    wrong = rng.random(SHAPE) < 0.33
    found = planes_of(np.where(wrong, 30 * rng.random(SHAPE), truth).astype(np.float32), regions, image)
    assert np.nanmax(np.abs(found.disparity.value - truth)) < 0.1


def test_a_curved_surface_is_left_alone():
    """No plane is near enough to a bowl: nothing is said, and the premise counts as violated there."""
    regions, image = halves()
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    bowl = (0.02 * ((x - 45) ** 2 + (y - 30) ** 2)).astype(np.float32)
    said = []
    evidence = DisparityEvidence.of(bowl, 0.2, 0.95)
    inputs = RegionPlanesInputs(left=image, evidence=evidence, regions=regions)
    context = Context(note=lambda what, name, value: said.append((what, name, value)))
    found = RegionPlanes().run(inputs, context).disparity
    assert not found.reliability.any()
    (held,) = (value[0] for what, name, value in said if (what, name) == ("assumed", "smoothness"))
    assert list(held[1:]) == [False, False]


def test_a_region_without_votes_takes_its_neighbours_plane():
    """The right half has no votes at all and the left one's colour: one wall behind both."""
    regions = halves()[0]
    truth = plane(0.02, 0, 10)
    even = np.full(SHAPE, 0.5, np.float32)
    hole = regions == 2
    found = planes_of(truth, regions, even, hole, right=even).disparity
    assert np.abs(found.value - truth)[hole].max() < 0.05
    assert found.reliability[hole].mean() < found.reliability[~hole].mean()


def test_no_plane_hides_what_the_right_view_sees():
    """Where the right view sees something behind, a plane in front of it keeps silent."""
    regions = halves()[0]
    truth = plane(0, 0, 10)
    hole = regions == 2
    behind = np.full(SHAPE, 10, np.float32)
    behind[:, 35:] = 2  # what left pixels from column 45 on would hide
    found = planes_of(truth, regions, np.full(SHAPE, 0.5, np.float32), hole, right_disparity=behind).disparity
    assert not found.reliability[hole].any()
    assert found.reliability[:, :44].all()


def test_a_plane_has_to_look_alike_in_both_views():
    """Without votes, texture decides: the neighbour's plane is taken if the views match on it, else not."""
    rng = np.random.default_rng(4)
    regions, hole = halves()[0], halves()[0] == 2
    wide = rng.random((SHAPE[0], SHAPE[1] + 10), dtype=np.float32)
    left, right = wide[:, :-10], wide[:, 10:]
    truth = plane(0, 0, 10)
    alike = planes_of(truth, regions, left, hole, right=right).disparity
    other = planes_of(truth, regions, left, hole, right=rng.random(SHAPE, dtype=np.float32)).disparity
    assert (alike.reliability[hole] > 0).mean() > 0.95
    assert not other.reliability[hole].any()


def test_energy_and_share_are_knobs():
    """Half of the votes on a plane: accepted only if as small a share will do."""
    regions, image = halves()
    rng = np.random.default_rng(1)
    truth = plane(0.1, 0.05, 10)
    mixed = np.where(rng.random(SHAPE) < 0.45, 30 * rng.random(SHAPE), truth).astype(np.float32)
    assert not planes_of(mixed, regions, image, share=0.8).disparity.reliability.any()
    assert planes_of(mixed, regions, image, share=0.5).disparity.reliability.any()
    assert not planes_of(mixed, regions, image, share=0.5, energy=0.01).disparity.reliability.any()


def test_nothing_known_says_nothing():
    image = halves()[1]
    none = DisparityEvidence.of(np.full(SHAPE, np.nan, np.float32), 1.0, 0.0)
    found = RegionPlanes().run(RegionPlanesInputs(left=image, evidence=none), HERE)
    assert not found.disparity.reliability.any()
    assert found.regions.min() >= 1


def test_the_guide_is_strong_where_the_first_pass_doubts():
    """Planes where they speak, the matching elsewhere; next to no weight where that is sure."""
    first = DisparityEvidence.of(plane(0, 0, 5), 1.0, np.where(plane(1, 0, 0) < 45, 0.99, 0.1))
    planes = DisparityEvidence.of(plane(0, 0, 7), 1.0, np.where(plane(0, 1, 0) < 30, 0.9, 0))
    prior = Guide().run(Guide.Inputs(evidence=first, planes=planes), HERE).prior
    assert (prior.value[:30] == 7).all()
    assert (prior.value[30:] == 5).all()
    assert prior.reliability[:, :45].max() < 0.05
    assert prior.reliability[0, -1] == 1
    assert 0 < prior.reliability[-1, -1] < 0.5


def test_mending_never_touches_what_both_views_agree_on():
    """Consistent pixels stay as they are, holes take the plane, and what has neither stays filled."""
    given = DisparityEvidence.of(plane(0, 0, 5), 1.0, 0.8)
    planes = DisparityEvidence.of(plane(0, 0, 7), 1.0, np.where(plane(1, 0, 0) < 60, 0.9, 0))
    consistent = plane(1, 0, 0) < 30
    found = Mend().run(MendInputs(evidence=given, planes=planes, consistent=consistent), HERE).disparity
    assert [float(found.value[0, x]) for x in (0, 40, 80)] == [5, 7, 5]
    assert found.reliability[0, 0] > found.reliability[0, 80]


def test_a_second_matching_that_moved_is_trusted_less():
    given = DisparityEvidence.of(plane(0, 0, 5), 1.0, 0.8)
    planes = DisparityEvidence.of(plane(0, 0, 5), 1.0, 0.9)
    trusts = []
    for before in (5, 9):
        earlier = DisparityEvidence.of(plane(0, 0, before), 1.0, 0.8)
        inputs = MendInputs(evidence=given, planes=planes, consistent=np.ones(SHAPE, bool), earlier=earlier)
        trusts.append(Mend().run(inputs, HERE).disparity.reliability.mean())
    assert trusts[1] < trusts[0]


@pytest.mark.parametrize("color", [False, True])
def test_the_graph_runs_with_and_without_colour(color):
    """A textured plane with an even patch in it: the graph is at least as near as matching alone."""
    rng = np.random.default_rng(7)
    wide = rng.random((64, 120), dtype=np.float32)
    wide[20:44, 40:80] = 0.5
    left, right = wide[:, :-12].copy(), wide[:, 12:].copy()
    given = {"color": np.repeat(left[..., None], 3, axis=2)} if color else {}
    camera = visint.Camera.uncalibrated(108, 64, (0, 24))
    alone = visint.run("stereo_sgm", left=left, right=right, camera=camera)
    whole = visint.run("stereo_planes", left=left, right=right, camera=camera, **given)
    off = [np.nanmean(np.abs(result["disparity"] - 12)) for result in (alone, whole)]
    assert off[1] <= off[0] + 0.01
    assert off[1] < 0.5
