"""Tables 4.3 and 4.4 as corrected, at the values that were worked out."""

from __future__ import annotations

from math import inf, radians

import numpy as np
import pytest

from visint_lines.catalogue import LABELS
from visint_lines.diagram import Arc, Diagram, Junction, Measures, Spoke
from visint_lines.limbness import limb_points, limb_runs, withdrawn
from visint_lines.priors import Thresholds, arc_prior, type_prior


def said(background="", floating=0.5, **features):
    exact = {"spread": 0.0, "spread_dihedral": 0.0, "seen": 1.0}
    prior = arc_prior(Measures(**{**exact, **features}), background, floating, Thresholds())
    return dict(zip(LABELS, prior, strict=True))


class TestArcs:
    def test_a_right_angle_is_a_crease(self):
        assert said(dihedral=radians(90))["+"] > 0.85
        assert said(dihedral=radians(-90))["-"] > 0.85

    def test_nine_degrees_are_the_threshold(self):
        prior = said(dihedral=radians(9))
        assert prior["+"] == pytest.approx(prior["x"], rel=0.2)

    def test_nothing_changes_at_a_mark(self):
        assert said()["x"] > 0.8

    @pytest.mark.parametrize(("gap", "label"), [(40.0, "<"), (-40.0, ">"), (inf, "<"), (-inf, ">")])
    def test_the_nearer_side_occludes_whatever_the_angle(self, gap, label):
        assert said(gap=gap, dihedral=radians(80))[label] > 0.95

    def test_a_limb(self):
        assert said(gap=40.0, left=0.9)["<<"] > 0.95
        assert said(gap=-40.0, right=0.9)[">>"] > 0.95

    def test_noise_makes_it_unsure(self):
        """The same bend with a large error says less."""
        assert said(dihedral=radians(30), spread_dihedral=radians(30))["+"] < said(dihedral=radians(30))["+"]

    def test_without_depth_the_floating_preference_speaks(self):
        prior = dict(zip(LABELS, arc_prior(None, "left", 0.9, Thresholds()), strict=True))
        assert prior[">"] == max(prior.values())
        assert prior[">"] / prior["<"] == pytest.approx(9)


def junction(degrees, limbness=0.0, smooth=False):
    told = Measures(left=limbness)
    arcs = tuple(Arc(0, 0, 1, 2, np.zeros((2, 2)), "", told) for _ in degrees)
    spokes = tuple(Spoke(i, True, radians(d)) for i, d in enumerate(degrees))
    made = Junction(5.0, 5.0, spokes, smooth=smooth)
    return type_prior(Diagram((10, 10), (made,), arcs), made)


class TestJunctions:
    @pytest.mark.parametrize(
        ("degrees", "kind"),
        [
            ((0, 120, 240), "Y"),
            ((0, 100, 260), "Y"),
            ((0, 90, 180), "T"),
            ((0, 80, 160), "W"),
            ((0, 45, 90), "W"),
            ((0, 90), "L"),
            ((0, 150), "L"),
            ((0, 178), "P"),
        ],
    )
    def test_by_angles(self, degrees, kind):
        prior = junction(degrees)
        assert max(prior, key=prior.get) == kind
        assert sum(prior.values()) == pytest.approx(1)

    def test_three_tangents_with_a_limb(self):
        prior = junction((0, 175, 185), limbness=1.0)
        assert max(prior, key=prior.get) == "R"

    def test_arcs_that_meet_smoothly_are_no_corner(self):
        assert junction((0, 150), smooth=True)["L"] < 0.05

    def test_four_lines_and_the_frame_are_not_constrained(self):
        assert junction((0, 90, 180, 270)) == {}


class TestLimbness:
    @pytest.mark.parametrize("radius", [14.0, 40.0, 400.0])
    def test_a_ball_is_a_limb_and_a_plane_is_none(self, radius):
        """sin of the angle is 1 − s/r on a circle; a slanted plane keeps its angle."""
        offset = np.arange(1.0, 11.0)
        ball = np.arcsin(np.clip(1 - offset / radius, -1, 1))
        plane = np.full(10, radians(80))
        passed, asked, _ = limb_points(np.stack([ball, plane]), offset, 0.01, radians(68))
        assert passed.tolist() == [True, False]
        assert asked.all()

    def test_too_few_samples_say_nothing(self):
        """Unless the surface is seen at a very low angle."""
        offset = np.arange(1.0, 11.0)
        for angle, limb in ((1.2, False), (1.4, True)):
            passed, asked, _ = limb_points(np.where(offset < 4, angle, np.nan), offset, 0.01, radians(68))
            assert passed == asked == limb

    def test_a_limb_ends_where_the_rim_begins(self):
        """The rim at first still looks like a limb, but at the boundary itself it is not seen edge-on."""
        edge = np.radians([90.0] * 12 + [80.0] * 8 + [40.0] * 20)
        assert withdrawn([(0, 20, True), (20, 40, False)], edge, closed=False) == [0, 12]
        turned = np.roll(edge, 10)
        assert sorted(at % 40 for at in withdrawn([(10, 30, True), (30, 50, False)], turned, True)) == [10, 22]

    def test_stretches_of_a_line(self):
        """Single points that fail do not break a limb; a closed line's stretch may run across its seam."""
        passed = np.array([True] * 20 + [False] * 20)
        passed[7] = False
        sure = np.ones(40, bool)
        assert limb_runs(passed, sure, closed=False) == [(0, 20, True), (20, 40, False)]
        around = limb_runs(np.roll(passed, 10), sure, closed=True)
        assert sorted(end - start for start, end, _ in around) == [20, 20]
        assert limb_runs(passed[:0], sure[:0], closed=False) == []
