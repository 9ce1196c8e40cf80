"""Assumptions in a result: by node and region, from what modules said last at the finest level."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import visint
import visint.testing.plugin
from visint.graph import parse_graph
from visint.module import Context
from visint.registry import Catalog
from visint.results import Record
from visint.results.premises import WHOLE, Premise
from visint.results.provenance import provenance
from visint.results.records import Assumed
from visint.results.report import report

TWO = """
visint: 1
name: two
inputs: {image: Image}
nodes: {edges: {uses: toy.boundary_cue, in: {image: inputs.image}}}
outputs: {boundaries: edges.evidence}
"""


def two_regions():
    """Dark and even on the left (24 pixels), bright and uneven on the right; a boundary column between."""
    image = np.zeros((4, 12), np.float32)
    image[:, 6:] = np.linspace(0.7, 0.95, 6, dtype=np.float32)
    return image


def test_by_region_with_pixels():
    """Homogeneity held in the dark region and not in the bright one; opacity was never looked at."""
    found = visint.run(parse_graph(TWO, Catalog({"toy": visint.testing.plugin})), image=two_regions())
    assert found.assumptions == {
        "edges": {
            "opacity": Premise(),
            "homogeneity": Premise(held={1: 24}, violated={2: 20}, level=0, turn=0),
        }
    }
    told = provenance(found, {})["assumptions"]["edges"]
    assert told == {
        "opacity": {"state": "untested"},
        "homogeneity": {"state": "mixed", "level": 0, "turn": 0, "held": {"1": 24}, "violated": {"2": 20}},
    }
    assert json.loads(json.dumps(told)) == told


def test_the_finest_level_and_the_last_turn_count():
    record = Record()
    for level, turn, held in ((1, 5, False), (0, 0, False), (0, 1, True), (1, 0, False)):
        record.note_assumed(Assumed("a", level, turn, "opacity", held, None, (2, 3)))
    (said,) = record.assumed.values()
    assert (said.level, said.turn, said.held) == (0, 1, True)


def test_states_and_shares():
    assert Premise().state == "untested"
    assert math.isnan(Premise().share)
    assert Premise({WHOLE: 6}).state == "held"
    assert Premise({}, {WHOLE: 6}).state == "violated"
    assert Premise({1: 3}, {2: 1}).share == 0.75


def test_a_hub_run_says_it_of_the_finest_level(met):
    """The toy hub's grouping spoke speaks at every level and turn; the whole size is left on record."""
    premise = met.assumptions["edges"]["homogeneity"]
    assert premise.level == 0
    assert 0 < sum((premise.held | premise.violated).values()) <= 48 * 64


def test_the_report_has_a_table(met):
    page = report(met)
    assert 'id="assumptions"' in page
    assert "One texture covers a surface" in page
    assert "not tested" in page


def test_nothing_happens_without_an_observer():
    Context().assumed("opacity", True)


def test_flags_are_by_label():
    """A flag a pixel is a mistake, and is said to be."""
    said = []
    context = Context(note=lambda what, name, value: said.append((what, name, value)))
    context.assumed("opacity", np.True_)
    assert said == [("assumed", "opacity", (True, None))]
    with pytest.raises(ValueError, match="one flag a label"):
        context.assumed("opacity", np.ones((2, 2), bool), np.ones((2, 2), np.int32))
