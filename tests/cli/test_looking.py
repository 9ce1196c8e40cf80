"""``check``, ``show`` and ``modules``: looking at graphs and plugins without running anything."""

from __future__ import annotations

import pytest

from visint.testing import installed

LOOP = """visint: 1
name: around
about: Counts.
inputs: {first: Scalar, other: Scalar?}
loops: {turns: {times: 3}}
nodes:
  count: {uses: toy.add, loop: turns, in: {a: inputs.first}, feedback: {b: {from: count.sum, start: 0}}}
outputs: {sum: count.sum}
"""


class TestCheck:
    """Reads, binds, checks."""

    @pytest.mark.parametrize("graph", ["stereo", "stereo_sgm"])
    def test_sound(self, visint, graph):
        done = visint("check", graph)
        assert (done.code, done.err) == (0, "")
        assert done.out.startswith(f"{graph}: ")
        assert done.out.endswith("sound\n")
        assert len(done.out.splitlines()) == 1

    def test_json_of_nothing_wrong(self, visint):
        assert visint("check", "stereo_sgm", "--json").json == []

    def test_json_of_everything_wrong(self, visint, toys, tmp_path):
        """All problems of a phase, each with its place and the line to write."""
        text = LOOP.replace("other: Scalar?", "l: Image").replace("a: inputs.first", "c: inputs.first")
        text = text.replace("sum: count.sum}", "sum: count.nope}")
        (tmp_path / "bad.yaml").write_text(text)
        done = visint("check", "bad.yaml", "--json")
        assert done.code == 2
        assert done.err == ""
        assert {one["code"] for one in done.json} == {"VI202", "VI206"}
        assert {one["line"] for one in done.json} == {7, 8}
        assert all(one["file"] == "bad.yaml" and one["write"] and one["fault"] == "graph" for one in done.json)

    @pytest.mark.parametrize("graph", ["nope.yaml", ".", "", "no such graph"])
    def test_no_graph(self, refused, graph):
        assert refused(2, "check", graph).startswith("VI10")

    def test_missing_plugin(self, visint, tmp_path):
        (tmp_path / "g.yaml").write_text(LOOP)
        done = visint("check", "g.yaml")
        assert done.code in (2, 4)
        assert "toy" in done.err
        assert "plugins: bayes, " in done.err


class TestShow:
    """A graph as it will run."""

    def test_order_loops_feedback_and_what_is_unbound(self, visint, toys, tmp_path):
        (tmp_path / "g.yaml").write_text(LOOP)
        done = visint("show", "g.yaml")
        assert (done.code, done.err) == (0, "")
        lines = done.out.splitlines()
        assert lines[0] == "around: Counts."
        assert "  input other: Scalar?" in lines
        loop = next(i for i, line in enumerate(lines) if line.startswith("  loop turns (times: 3)"))
        assert lines[loop + 1].startswith("    count: toy.add  (a < inputs.first, b << count.sum)")
        assert lines[-1].startswith("  output sum: count.sum")

    def test_unbound_ports_are_listed(self, visint, tmp_path):
        text = """visint: 1
name: m
inputs: {l: Image, r: Image}
nodes: {a: {uses: stereo.sgm, in: {left: inputs.l, right: inputs.r}}}
outputs: {d: a.disparity}
"""
        (tmp_path / "m.yaml").write_text(text)
        assert "unbound: camera" in visint("show", "m.yaml").out

    def test_expanded_is_a_graph_of_the_same_kind(self, visint, tmp_path):
        text = visint("show", "stereo", "--expand").out
        (tmp_path / "plain.yaml").write_text(text)
        assert visint("check", "plain.yaml").code == 0
        assert visint("show", "plain.yaml", "--expand").out == text

    @pytest.mark.parametrize(("flag", "start"), [("--dot", "digraph"), ("--html", "<!doctype html")])
    def test_drawings(self, visint, flag, start):
        pytest.importorskip("visint.graph.drawing")
        done = visint("show", "stereo", flag)
        assert done.code == 0
        assert done.out.lower().lstrip().startswith(start)

    def test_one_view_at_a_time(self, refused):
        assert "exclude" in refused(2, "show", "stereo", "--dot", "--expand")


class TestModules:
    """What is installed."""

    def test_list(self, visint):
        done = visint("modules")
        assert (done.code, done.err) == (0, "")
        assert "stereo (visint " in done.out
        line = next(line for line in done.out.splitlines() if line.startswith("  stereo.sgm "))
        assert "semi-global matching" in line

    def test_list_as_json(self, visint):
        plugins = {one["plugin"]: one for one in visint("modules", "--json").json}
        assert "stereo.sgm" in plugins["stereo"]["modules"]

    def test_one(self, visint):
        done = visint("modules", "stereo.sgm")
        assert done.code == 0
        for word in (
            "10.1109/TPAMI.2007.1166",
            "left: Image float32 (H, W)",
            "Disparity evidence",
            "speckle = 100",
        ):
            assert word in done.out
        assert "Islands of up to" in done.out, "what turning a parameter does"

    def test_one_as_json(self, visint):
        told = visint("modules", "stereo.sgm", "--json").json
        assert told["parameters"]["speckle"]["default"] == 100
        assert told["inputs"]["camera"] == "Camera?"

    def test_assumptions_with_their_sentences(self, visint, toys):
        assert "  opacity: One surface is seen at a pixel" in visint("modules", "toy.boundary_cue").out
        told = visint("modules", "toy.boundary_cue", "--json").json["assumptions"]
        assert list(told) == ["opacity", "homogeneity"]

    def test_those_of_a_plugin(self, visint):
        out = visint("modules", "stereo").out
        assert "stereo.sgm" in out
        assert "lab." not in out

    @pytest.mark.parametrize("typed", ["stereo.smg", "stero.sgm", "stereosgm"])
    def test_near_miss(self, refused, typed):
        assert "Write: visint modules stereo.sgm" in refused(2, "modules", typed)

    @pytest.mark.parametrize(
        ("files", "said"),
        [
            ({"frail.py": "import nothing_at_all"}, "nothing_at_all"),
            ({"frail.py": "raise SystemExit(3)"}, "exit"),
            ({"frail.py": "visint_contract = 99"}, "contract"),
            (
                {"frail.py": "from visint.hookspecs import hookimpl\n@hookimpl\ndef visint_modules(): 1 / 0"},
                "division",
            ),
        ],
        ids=["import", "exit", "contract", "hook"],
    )
    def test_broken_plugin(self, visint, files, said):
        """Listed as BROKEN with the reason and its distribution; the others are listed all the same."""
        with installed("frail-plugin", plugins={"frail": "frail"}, files=files):
            done = visint("modules")
            as_json = visint("modules", "--json")
            alone = visint("modules", "frail.any")
        assert done.code == as_json.code == 4
        assert "frail: BROKEN" in done.out
        assert "frail-plugin 1.0" in done.out
        assert said.lower() in done.out.lower()
        assert "  stereo.sgm " in done.out
        assert [one["plugin"] for one in as_json.json if "broken" in one] == ["frail"]
        assert alone.code == 4
        assert "frail-plugin 1.0" in alone.err

    def test_two_distributions_of_one_name(self, visint):
        both = {"plugins": {"twin": "twin"}, "files": {"twin.py": ""}}
        with installed("first", **both), installed("second", **both):
            done = visint("modules")
        assert done.code == 4
        assert all(name in done.out for name in ("twin: BROKEN", "first 1.0", "second 1.0", "stereo.sgm"))
