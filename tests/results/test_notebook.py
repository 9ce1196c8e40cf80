"""What a notebook shows: results, graphs, evidence and maps as pictures; the whole report in a frame."""

from __future__ import annotations

import re
import sys
import webbrowser
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

import visint
from visint.events import NodeFinished
from visint.fields import DepthEvidence
from visint.graph import parse_graph


@pytest.fixture
def opened(monkeypatch, tmp_path):
    """Addresses that the web browser was told to open."""
    seen: list[str] = []
    monkeypatch.setattr(webbrowser, "open", seen.append)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    return seen


def test_a_result_is_a_row_of_its_outputs(met, toys):
    """Each map with its legend, the warnings, and what is no map."""
    html = met._repr_html_()
    alts = [alt.split(":")[0] for alt, _ in toys.pictures(html) if not alt.startswith("Key")]
    assert alts == [
        *("Depth depth", "Normals normals", "Boundaries boundaries", "Regions regions"),
        *("Confidence depth_confidence", "Disparity disparity"),
    ]
    assert "this is only a toy" in html
    assert "count = " in html


def test_evidence_is_value_sigma_and_reliability(toys):
    value = np.linspace(1, 2, 20, dtype=np.float32).reshape(4, 5)
    html = DepthEvidence.of(value, 0.1, 0.5)._repr_html_()
    assert [alt.split(":")[0] for alt, _ in toys.pictures(html)] == [
        "Depth value",
        "Sigma sigma",
        "Confidence reliability",
    ]


def test_a_map_is_its_fields_and_what_is_known_of_each(toys):
    """As an observer receives it."""
    maps = []

    def keep(event):
        if isinstance(event, NodeFinished) and hasattr(event.outputs, "snapshot"):
            maps.append(event.outputs.snapshot)

    image = toys.scene(16, 20)
    graph = parse_graph(toys.HUB, toys.catalog())
    inputs = {"left": image, "right": image, "camera": toys.camera((16, 20))}
    visint.run(graph, inputs, options=visint.Options(observers=(keep,)))
    alts = [alt.split(":")[0] for alt, _ in toys.pictures(maps[-1]._repr_html_())]
    assert alts[:2] == ["Depth depth", "Confidence confidence of depth"]
    assert "Boundaries boundaries" in alts


def test_a_graph_is_its_drawing(met):
    assert met.graph._repr_html_().startswith("<svg ")


def test_elsewhere_the_report_is_opened_in_the_browser(met, opened):
    """It is written whole into a new temporary folder."""
    shown = visint.show(met)
    assert opened == [shown.path.as_uri()]
    assert "meeting – visint report" in shown.path.read_text()
    assert repr(shown) == f"<Shown at {shown.path}>"


def test_in_a_notebook_it_is_a_frame_that_reaches_nothing(met, opened, monkeypatch):
    """Nothing is written and no browser opened; the page in the frame is the report."""
    kernel = SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=object()))
    monkeypatch.setitem(sys.modules, "IPython", kernel)
    shown = visint.show(met)
    html = shown._repr_html_()
    assert shown.path is None
    assert not opened
    assert 'sandbox="allow-scripts"' in html
    page = unescape(re.search(r'srcdoc="([^"]*)"', html)[1])
    assert page == shown.page
    assert repr(shown) == "<Shown>"


def test_a_terminal_with_ipython_is_no_notebook(met, opened, monkeypatch):
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=object))
    assert visint.show(met).path is not None


def test_it_compares_with_another_run(met, opened, tmp_path):
    met.save(tmp_path / "before")
    assert "equal to the last bit" in visint.show(met, against=tmp_path / "before").page
