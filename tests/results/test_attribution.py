"""Attribution in files and in the report."""

from __future__ import annotations

import numpy as np
import pytest

import visint
from visint import io
from visint.engine import Options
from visint.graph import parse_graph
from visint.results.provenance import provenance
from visint.results.report import report


@pytest.fixture(scope="module")
def followed(toys):
    """The toy hub, with attribution."""
    image = toys.scene(48, 64)
    inputs = {"left": image, "right": image * np.float32(0.9), "camera": toys.camera((48, 64))}
    return visint.run(parse_graph(toys.HUB, toys.catalog()), inputs, options=Options(attribution=True))


def test_saved_beside_the_evidence(followed, tmp_path):
    """One array a cue and field, float32 in [0, 1]; its unit is told in the record."""
    followed.save(tmp_path / "out")
    arrays = io.read_npz(tmp_path / "out/evidence.npz")
    for name, weights in followed.attribution.items():
        for cue, weight in weights.items():
            np.testing.assert_array_equal(arrays[f"{cue}.share_of_{name}"], weight)
    units = provenance(followed, {})["evidence_units"]
    assert units.keys() == arrays.keys()
    assert (units["match.disparity"], units["match.share_of_depth"]) == ("px", "1")


def test_told_in_the_record(followed):
    """The mean share of each cue."""
    told = provenance(followed, {})["attribution"]
    assert set(told) == {"depth", "boundaries"}
    for cue, mean in told["depth"].items():
        assert mean == pytest.approx(float(followed.attribution["depth"][cue].mean()), abs=1e-5)


def test_one_map_a_cue_in_the_report(followed, met, toys):
    """A section with a picture a cue, and one of what the start decides where it does; none if not followed."""
    page = report(followed)
    assert 'id="attribution"' in page
    titles = [alt for alt, _ in toys.pictures(page)]
    for cue in ("shade", "match"):
        assert any(alt.startswith(f"Confidence {cue}") for alt in titles)
    assert "edges decided all of it." in page
    assert 'id="attribution"' not in report(met)


def test_following_changes_no_output(followed, met):
    """The run is the same, bit by bit."""
    for name, value in met.outputs.items():
        np.testing.assert_array_equal(followed.outputs[name], value)
