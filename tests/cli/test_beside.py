"""``--rerun`` and ``--against``: a recording beside the results, and a comparison in the report."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import pytest


@pytest.fixture
def library(monkeypatch):
    """A stand-in for the Rerun library, which keeps nothing."""
    stream = SimpleNamespace(
        set_time=lambda *_, **__: None,
        log=lambda *_: None,
        binary_stream=lambda: SimpleNamespace(read=lambda: b"RRF2 stand-in"),
    )
    made = dict.fromkeys(("EncodedImage", "DepthImage", "Pinhole", "Scalars", "TextLog"), lambda *_, **__: None)
    monkeypatch.setitem(sys.modules, "rerun", SimpleNamespace(RecordingStream=lambda _: stream, **made))


class TestRerun:
    def test_a_recording_is_written(self, visint, pair, library, tmp_path):
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out", "--rerun", "run.rrd")
        assert done.code == 0
        assert (tmp_path / "run.rrd").read_bytes() == b"RRF2 stand-in"

    def test_the_missing_extra_is_told_before_the_work(self, refused, pair, monkeypatch):
        """Two: the command line asks for what is not there."""
        monkeypatch.setitem(sys.modules, "rerun", None)
        said = refused(2, "run", "stereo_sgm", *pair.all, "--out", "out", "--rerun", "run.rrd")
        assert "pip install 'visint[rerun]'" in said

    def test_a_folder_that_is_missing_is_told_before_the_work(self, refused, pair, library):
        said = refused(5, "run", "stereo_sgm", *pair.all, "--out", "out", "--rerun", "no/run.rrd")
        assert "does not exist" in said


class TestAgainst:
    def test_the_report_compares(self, visint, pair, former, tmp_path):
        """With itself nothing differs; the artifacts are the same as without it."""
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out", "--against", former)
        assert done.code == 0
        page = (tmp_path / "out/report.html").read_text()
        assert page.count("equal to the last bit") == 3  # disparity, depth, normals
        for name in ("depth.pfm", "run.json"):
            assert (tmp_path / "out" / name).read_bytes() == (former / name).read_bytes()

    def test_what_was_set_otherwise(self, visint, pair, former, tmp_path):
        options = ("--set", "match.speckle=7", "--against", former)
        assert visint("run", "stereo_sgm", *pair.all, "--out", "out", *options).code == 0
        assert "<code>match.speckle</code></th><td>7</td>" in (tmp_path / "out/report.html").read_text()

    @pytest.mark.parametrize("folder", ["nowhere", "."])
    def test_no_run_is_told_before_the_work(self, refused, pair, folder):
        said = refused(3, "run", "stereo_sgm", *pair.all, "--out", "out", "--against", folder)
        assert "run.json" in said
