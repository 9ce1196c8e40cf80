"""Drawings whose grouping is plain to see."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from visint.module import Context
from visint_grouping.gestalt import Weights, coherence, costs, voronoi_neighbours
from visint_grouping.perceptual import Perceptual
from visint_grouping.spoke import SOURCES, GroupingInputs
from visint_grouping.strokes import sites, stroked, thinned
from visint_grouping.voronoi import Voronoi, VoronoiParams

LINK = SOURCES.index("link")


def drawn(*segments, shape=(96, 128)):
    """Lines (row, column, row, column), one pixel wide."""
    lines = np.zeros(shape, np.uint8)
    for r0, c0, r1, c1 in segments:
        cv2.line(lines, (c0, r0), (c1, r1), 1)
    return lines > 0


def halves(row, shape=(96, 128), low=0.3, high=0.7):
    """A scene of two even halves, and its regions."""
    image, regions = np.full(shape, low, np.float32), np.ones(shape, np.int32)
    image[row:], regions[row:] = high, 2
    return image, regions


def linked(image, edges, segments, **params):
    inputs = GroupingInputs(image=image, edges=edges, segments=segments)
    return Voronoi(VoronoiParams(**params)).run(inputs, Context())


def test_two_collinear_segments_link_over_ten_pixels():
    """Both sides differ in brightness all along: the gap of 10 px is closed, and known to be a link."""
    image, regions = halves(48)
    found = linked(image, drawn((47, 10, 47, 54), (47, 65, 47, 118)), regions, extension=0)
    assert found.evidence.value[47, 55:65].all()
    assert (found.support[47, 55:65, LINK] == 1).all()
    assert (found.evidence.reliability[47, 55:65] > 0.8).all()
    assert not found.support[47, 12:50, LINK].any()


def test_two_parallel_segments_do_not_link():
    """Side by side, 10 px apart, both of them boundaries of regions: to link them takes two right angles."""
    image, regions = halves(44)
    image[54:], regions[54:] = 0.3, 3
    found = linked(image, drawn((43, 20, 43, 100), (53, 20, 53, 100)), regions, extension=0)
    assert found.evidence.value[43, 25:95].all()
    assert not found.support[..., LINK].any()
    assert not found.evidence.value[45:52].any()


def test_a_square_with_a_missing_corner_closes():
    """Two ends at right angles, each 8 px from the corner: a straight link closes the square."""
    image, regions = np.full((96, 128), 0.3, np.float32), np.ones((96, 128), np.int32)
    image[24:72, 40:88], regions[24:72, 40:88] = 0.8, 2
    sides = ((24, 40, 24, 79), (24, 40, 71, 40), (71, 40, 71, 87), (71, 87, 32, 87))
    edges = drawn(*sides)
    _, before = cv2.connectedComponents((~edges).astype(np.uint8), connectivity=4)
    assert before[0, 0] == before[48, 64]
    found = linked(image, edges, regions, extension=0)
    assert found.support[..., LINK].any()
    assert found.regions.max() == 2
    assert found.regions[0, 0] != found.regions[48, 64]


def test_a_link_over_even_ground_is_refused():
    """The same collinear segments, but at the gap both sides are one region: no contrast, no link."""
    image, regions = halves(48)
    image[:, 52:68], regions[:, 52:68] = 0.5, 3
    found = linked(image, drawn((47, 10, 47, 54), (47, 65, 47, 118)), regions, extension=0, least=0.3)
    assert not found.support[..., LINK].any()
    assert not found.evidence.value[47, 56:64].any()


def test_extension_goes_where_two_agree():
    """Beyond a gap of 3 px the edge goes on, and regions change all along: the end is extended."""
    image, regions = halves(48)
    edges = drawn((47, 10, 47, 60), (47, 64, 47, 110))
    found = linked(image, edges, regions, least=1.0)
    assert found.evidence.value[47, 61:64].all()
    assert (found.support[47, 61:64, SOURCES.index("extension")] == 1).all()


def test_coherence_is_the_share_that_agrees():
    """Eq. 5.19: where edges and regions, which alone take part, agree it is 1; flat depth has no say."""
    image, regions = halves(48)
    edges = drawn((47, 0, 47, 127))
    depth = np.full(image.shape, 20, np.float32)
    inputs = {"image": image, "edges": edges, "segments": regions}
    found = Voronoi().run(GroupingInputs(**inputs, depth=depth), Context())
    assert (found.evidence.reliability[47, 5:120] == 1).all()
    depth[:, 64:] = 40  # depth jumps elsewhere: a third word, which is no here
    found = Voronoi().run(GroupingInputs(**inputs, depth=depth), Context())
    assert np.allclose(found.evidence.reliability[47, 5:50], 2 / 3)
    assert (found.support[47, 20, :3] == [1, 1, 0]).all()


def test_costs_are_the_equations():
    """Two collinear lines of 40 px with a gap of 10, by hand: E of Eq. 5.20, β of the corrected 5.21."""
    lines = drawn((47, 10, 47, 49), (47, 60, 47, 99))
    found = sites(lines, stroked(lines))
    assert found.ends == 4
    shade = np.where(np.arange(96)[:, None] < 48, 50, 101).repeat(128, 1).astype(np.float32)
    inner = np.flatnonzero((found.place[:, 1] > 45) & (found.place[:, 1] < 65))
    weights = Weights(1.0, 1.0, 0.5, 0.01, 0.5)
    pair = np.array([inner])
    cost = costs(found, pair, weights, shade, None)
    proximity, cotermination, brightness = 11**2 / 40**2, 0.5 * 2 / 2, 0.01 * 255 / 51
    assert np.isclose(cost[0], proximity + cotermination + brightness)
    beta = coherence(cost, weights, with_depth=False)
    assert np.isclose(beta[0], 1 / (1 + cost[0] / 2.51))


def test_bends_cost_by_their_angles():
    """Ends that look away from each other: both angles π, so the term is w (π + π)/2π = w."""
    lines = drawn((47, 10, 47, 49), (47, 60, 47, 99))
    found = sites(lines, stroked(lines))
    outer = np.flatnonzero((found.place[:, 1] < 15) | (found.place[:, 1] > 95))
    only = Weights(0.0, 1.0, 0.0, 0.0, 0.0)
    assert np.isclose(costs(found, np.array([outer]), only, np.zeros((96, 128), np.float32), None)[0], 1.0)


def test_voronoi_neighbours_see_each_other():
    """Four corners and the middle: the middle is everybody's neighbour, opposite corners are none's."""
    place = np.array([[0, 0], [0, 10], [10, 0], [10, 10], [5, 5.0]])
    pairs = {tuple(pair) for pair in voronoi_neighbours(place).tolist()}
    assert {(0, 4), (1, 4), (2, 4), (3, 4)} <= pairs
    assert not pairs & {(0, 3), (1, 2)}
    row = np.array([[0, 3], [0, 1], [0, 9], [0, 5.0]])
    assert {tuple(pair) for pair in voronoi_neighbours(row).tolist()} == {(0, 1), (0, 3), (2, 3)}


def test_thinning_keeps_lines():
    """Lines two and three pixels thick in any direction become one pixel thick, a pixel or two shorter."""
    for end in ((20, 100), (80, 30), (80, 100), (50, 100)):
        thick = np.zeros((96, 128), np.uint8)
        cv2.line(thick, (30, 20), end[::-1], 1, 3)
        found = thinned(thick > 0)
        length = max(abs(end[0] - 20), abs(end[1] - 30)) + 1
        assert length - 6 <= found.sum() <= 1.3 * length + 4
    ring = drawn((20, 20, 20, 60), (20, 60, 60, 60), (60, 60, 60, 20), (60, 20, 20, 20))
    _, labels = cv2.connectedComponents((~thinned(ring)).astype(np.uint8), connectivity=4)
    assert labels[0, 0] != labels[40, 40]


def test_corners_are_sites():
    """A right angle is one site between two terminations."""
    lines = drawn((20, 20, 20, 60), (20, 60, 70, 60))
    found = sites(lines, stroked(lines))
    assert found.ends == 2
    assert len(found.place) == 3
    assert np.abs(found.place[2] - [20, 60]).max() <= 2


@pytest.mark.parametrize("noise", [0.0, 0.04])
def test_basins_merge_to_the_two_halves(noise):
    """One step of brightness, with and without noise: two regions, the boundary at the step."""
    image, _ = halves(48)
    image = image + np.random.default_rng(1).normal(0, noise, image.shape).astype(np.float32)
    found = Perceptual().run(GroupingInputs(image=image.clip(0, 1)), Context())
    assert found.regions.max() == 2
    rows = np.flatnonzero(found.evidence.value.any(axis=1))
    assert rows.min() >= 45
    assert rows.max() <= 50


def test_a_steady_shade_is_one_region():
    """A ramp of 120 grey levels has no boundary; nor has a parabola."""
    y, x = np.mgrid[:96, :128] / 128
    for image in (0.2 + 0.5 * x, 0.8 - 0.5 * (x - 0.5) ** 2 - 0.6 * (y - 0.3) ** 2):
        found = Perceptual().run(GroupingInputs(image=image.astype(np.float32)), Context())
        assert found.regions.max() == 1


def test_depth_divides_what_brightness_does_not():
    """An even image and a jump of depth: the boundary is there, supported by depth alone."""
    image = np.full((96, 128), 0.5, np.float32)
    image += np.random.default_rng(2).normal(0, 0.01, image.shape).astype(np.float32)
    depth = np.full(image.shape, 20, np.float32)
    depth[30:70, 40:90] = 14
    found = Perceptual().run(GroupingInputs(image=image, depth=depth), Context())
    assert found.regions.max() == 2
    assert found.regions[50, 60] != found.regions[5, 5]
    on = found.evidence.value
    assert found.support[..., SOURCES.index("depth")][on].mean() > 0.95
    assert Perceptual().run(GroupingInputs(image=image), Context()).regions.max() == 1


def test_regions_never_touch():
    """Of two neighbours in different regions one is a boundary, on noise, for both linkers."""
    image = cv2.GaussianBlur(np.random.default_rng(3).random((80, 90), dtype=np.float32), (0, 0), 2)
    image = (image - image.min()) / np.ptp(image)
    for module in (Perceptual(), Voronoi()):
        regions = module.run(GroupingInputs(image=image), Context()).regions
        for one, other in ((regions[:, :-1], regions[:, 1:]), (regions[:-1], regions[1:])):
            assert not ((one != other) & (one > 0) & (other > 0)).any()
