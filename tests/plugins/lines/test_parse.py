"""Label maps and edge maps whose junctions and lines are known."""

from __future__ import annotations

import numpy as np
import pytest

from visint.module import Context
from visint_lines.parse import Parse, ParseInputs
from visint_lines.trace import Trace, TraceInputs


def parsed(regions):
    return Parse().run(ParseInputs(regions=regions.astype(np.int32)), Context()).diagram


def disc(size, radius):
    y, x = np.mgrid[:size, :size] - (size - 1) / 2
    return np.hypot(x, y) < radius


class TestRegions:
    def test_one_region_has_no_lines(self):
        diagram = parsed(np.ones((20, 30)))
        assert not diagram.arcs
        assert not diagram.junctions

    def test_a_disc_is_one_closed_line(self):
        """Without corners, of the right length, with the disc on one hand and the background on the other."""
        diagram = parsed(1 + disc(100, 30))
        (arc,) = diagram.arcs
        assert arc.closed
        assert not diagram.junctions
        assert arc.length == pytest.approx(2 * np.pi * 30, rel=0.03)
        assert {arc.left, arc.right} == {1, 2}
        assert getattr(arc, arc.background) == 1

    @pytest.mark.parametrize("scale", [1, 2, 3])
    def test_a_square_has_four_corners_at_any_size(self, scale):
        regions = np.ones((60 * scale, 60 * scale))
        regions[15 * scale : 45 * scale, 15 * scale : 45 * scale] = 2
        diagram = parsed(regions)
        assert len(diagram.arcs) == len(diagram.junctions) == 4
        spots = sorted((round((j.x + 0.5) / scale), round((j.y + 0.5) / scale)) for j in diagram.junctions)
        np.testing.assert_allclose(spots, [(15, 15), (15, 45), (45, 15), (45, 45)], atol=1)
        for junction in diagram.junctions:
            a, b = junction.angles
            assert min(b - a, 2 * np.pi - b + a) == pytest.approx(np.pi / 2, abs=0.15)

    def test_three_regions_meet_at_one_junction(self):
        """A T: its stem ends at the frame like the bar; directions are right to 3 degrees."""
        regions = np.ones((80, 80))
        regions[40:] = 2
        regions[40:, 40:] = 3
        diagram = parsed(regions)
        inner = [j for j in diagram.junctions if not j.frame]
        assert [len(j.spokes) for j in inner] == [3]
        np.testing.assert_allclose(inner[0].angles, [-np.pi / 2, 0, np.pi], atol=0.05)
        assert sum(j.frame for j in diagram.junctions) == 3

    def test_specks_and_unlabelled_pixels_are_nothing(self):
        regions = np.ones((60, 60))
        regions[20:40, 20:40] = 2
        regions[5:7, 5:7] = 3
        regions[19, 19:41] = 0
        assert len(parsed(regions).arcs) == 4

    def test_chains_that_touch_pass_each_other_by(self):
        """Two squares corner to corner: no junction of four lines."""
        regions = np.ones((60, 60))
        regions[10:30, 10:30] = 2
        regions[30:50, 30:50] = 2
        assert all(len(j.spokes) == 2 for j in parsed(regions).junctions)

    def test_four_regions_at_a_point(self):
        regions = np.ones((60, 60))
        regions[:30, 30:], regions[30:, :30], regions[30:, 30:] = 2, 3, 4
        assert [len(j.spokes) for j in parsed(regions).junctions if not j.frame] == [4]


class TestEdges:
    def test_a_cross_of_thick_lines(self):
        """Four loose ends and one junction of four, whatever thinning leaves in the middle."""
        edges = np.zeros((80, 80), bool)
        edges[38:41, 10:70] = True
        edges[10:70, 38:41] = True
        diagram = Trace().run(TraceInputs(edges=edges), Context()).diagram
        assert sorted(len(j.spokes) for j in diagram.junctions if j.spokes) == [1, 1, 1, 1, 4]

    def test_a_ring_is_closed(self):
        ring = disc(80, 30) & ~disc(80, 28)
        diagram = Trace().run(TraceInputs(edges=ring), Context()).diagram
        assert [arc.closed for arc in diagram.arcs] == [True]

    def test_no_edges(self):
        assert not Trace().run(TraceInputs(edges=np.zeros((9, 9), bool)), Context()).diagram.arcs
