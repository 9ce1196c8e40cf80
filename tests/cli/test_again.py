"""Running again from ``run.json``: the same bytes, or a word about why not."""

from __future__ import annotations

import json
import shutil

import pytest

import visint as package
from visint import io

CHANGES = {"profile.json", "report.html"}
"""What tells the time, and nothing else."""


@pytest.fixture
def mine(former, tmp_path):
    """A copy of a former run that may be spoilt."""
    shutil.copytree(former, tmp_path / "former")
    return tmp_path / "former"


def spoil(folder, **changed):
    record = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps(record | changed))


def test_same_bytes(visint, former, tmp_path, files):
    assert visint("run", former / "run.json", "--out", "again").code == 0
    ours, theirs = files.contents(tmp_path / "again"), files.contents(former)
    assert set(ours) == set(theirs)
    assert {name for name in ours if ours[name] != theirs[name]} <= CHANGES


def test_over_itself(visint, mine, files):
    """A run may be done again in its own folder."""
    before = files.contents(mine)
    assert visint("run", mine / "run.json", "--out", mine).code == 0
    after = files.contents(mine)
    assert {name for name in after if after[name] != before[name]} <= CHANGES


def test_settings_and_options_are_kept(visint, pair, tmp_path, files):
    """What ``--set``, ``--gamma``, ``--seed`` and ``--disparity-range`` said is on record."""
    options = ["--set", "match.tolerance=2", "--gamma", 2, "--seed", 3, "--disparity-range", "1,9"]
    assert visint("run", "stereo_sgm", *pair.images, *options, "--out", "one").code == 0
    assert visint("run", "one/run.json", "--out", "two").code == 0
    one, two = files.contents(tmp_path / "one"), files.contents(tmp_path / "two")
    assert {name for name in one if one[name] != two[name]} <= CHANGES


def test_where_it_stopped_and_started_is_kept(visint, former, pair, tmp_path, files, mine, refused):
    """``--stop-after`` holds again; a run that started from a map wants that map."""
    assert visint("run", "stereo_sgm", *pair.images, "--stop-after", "match", "--out", "one").code == 0
    assert json.loads((tmp_path / "one/run.json").read_text())["stop_after"] == "match"
    assert visint("run", "one/run.json", "--out", "two").code == 0
    one, two = files.contents(tmp_path / "one"), files.contents(tmp_path / "two")
    assert {name for name in one if one[name] != two[name]} <= CHANGES
    spoil(mine, start={"depth": "0" * 64})
    assert "--from DIR" in refused(3, "run", mine / "run.json", "--out", "again")


def test_options_now_go_before_those_then(visint, former, pair, tmp_path):
    options = ["--right", pair.left, "--seed", 9, "--set", "match.speckle=7"]
    assert visint("run", former / "run.json", *options, "--out", "out").code == 0
    record = json.loads((tmp_path / "out/run.json").read_text())
    assert record["seed"] == 9
    assert record["inputs"]["right"]["sha256"] == record["inputs"]["left"]["sha256"]
    assert record["parameters"]["match"]["speckle"] == 7
    assert not [warned for warned in record["warnings"] if warned["code"] == "changed"]


def test_a_changed_file_is_told(visint, pair, tmp_path):
    """The image was edited since: the run is done, and says which input is another one."""
    for name in ("left.png", "right.png", "calib.txt"):
        shutil.copy(pair.folder / name, tmp_path / name)
    inputs = ["--left", "left.png", "--right", "right.png", "--calib", "calib.txt"]
    assert visint("run", "stereo_sgm", *inputs, "--out", "one").err == ""
    shutil.copy(tmp_path / "left.png", tmp_path / "right.png")
    done = visint("run", "one/run.json", "--out", "two")
    assert done.code == 0
    assert "inputs.right" in done.err
    assert "inputs.left" not in done.err


def test_the_graphs_that_it_calls_are_kept(visint, pair, tmp_path, files, monkeypatch):
    """A graph that calls another one is repeated as it was, though that file is now another one, or gone."""
    from visint.registry import catalog

    folder = tmp_path / "graphs"
    folder.mkdir()
    inner = "visint: 1\nname: inner\ninputs: {left: Image, right: Image}\nnodes: {m: {uses: stereo.sgm, in: "
    inner += "{left: inputs.left, right: inputs.right}}}\noutputs: {disparity: m.disparity}\n"
    (folder / "inner.yaml").write_text(inner)
    found = catalog._graph_files()
    monkeypatch.setattr(catalog, "_graph_files", lambda: {**found, "inner": {"test": folder / "inner.yaml"}})
    catalog._installed.cache_clear()
    (tmp_path / "outer.yaml").write_text(
        "visint: 1\nname: outer\ninputs: {left: Image, right: Image}\nnodes: {c: {uses: 'graph:inner', in: "
        "{left: inputs.left, right: inputs.right}}}\noutputs: {disparity: c.disparity}\n"
    )
    assert visint("run", "outer.yaml", *pair.images, "--out", "one").code == 0
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    catalog._installed.cache_clear()
    record = json.loads((tmp_path / "one/run.json").read_text())
    assert record["graphs"]["inner"]["nodes"]["m"]["uses"] == "stereo.sgm"
    assert visint("run", "one/run.json", "--out", "two").code == 0
    one, two = files.contents(tmp_path / "one"), files.contents(tmp_path / "two")
    assert {name for name in one if one[name] != two[name]} <= CHANGES


class TestFromPython:
    """A run on arrays left no paths on record."""

    @pytest.fixture
    def record(self, pair, tmp_path):
        images = {"left": io.read_image(pair.left), "right": io.read_image(pair.right)}
        package.run("stereo_sgm", images, camera=io.read_camera(pair.calib)).save(tmp_path / "python")
        return tmp_path / "python" / "run.json"

    def test_cannot_be_done_again_from_files(self, refused, record):
        said = refused(3, "run", record, "--out", "again")
        assert all(f"--in {name}=PATH" in said for name in ("left", "right", "camera"))

    def test_can_where_the_files_are_given(self, visint, record, pair, tmp_path):
        assert visint("run", record, *pair.all, "--out", "again").code == 0
        assert (tmp_path / "again/depth.pfm").read_bytes() == (record.parent / "depth.pfm").read_bytes()


class TestSpoilt:
    """A run record is data from anywhere."""

    @pytest.mark.parametrize(
        "changed",
        [
            {"inputs": []},
            {"inputs": {"left": "l.png"}},
            {"inputs": {"left": {"paths": "l.png"}}},
            {"inputs": {"left": {"paths": [1]}}},
            {"inputs": {"left": {"paths": ["l.png"], "gamma": "high"}}},
            {"seed": "x"},
            {"seed": None},
            {"graph": []},
            {"graphs": []},
        ],
    )
    def test_no_record(self, refused, mine, changed):
        spoil(mine, **changed)
        assert "no run record" in refused(3, "run", mine / "run.json", "--out", "again")

    def test_graph_in_it(self, refused, mine):
        spoil(mine, graph={"visint": 1, "name": "x", "nodes": {"a": {"uses": "os.system"}}})
        assert "VI" in refused(2, "run", mine / "run.json", "--out", "again")

    @pytest.mark.parametrize("text", ["", "{", "[]", "1", '{"visint": "0.1"}', "\0\1"])
    def test_text(self, refused, mine, text):
        (mine / "run.json").write_text(text)
        assert "run.json" in refused(3, "run", mine / "run.json", "--out", "again")

    def test_files_gone(self, refused, mine):
        record = json.loads((mine / "run.json").read_text())
        record["inputs"]["left"]["paths"] = ["/no/such/left.png"]
        spoil(mine, inputs=record["inputs"])
        assert "/no/such/left.png" in refused(3, "run", mine / "run.json", "--out", "again")
