"""What is wrong is told in a few lines on stderr, with the exit code of its kind and nothing left behind."""

from __future__ import annotations

import os
import resource

import cv2
import numpy as np
import pytest

from visint.testing import installed

BROKEN = """
from visint.hookspecs import hookimpl
from visint.module import Module, Params, Ports
from visint.arrays import Array, Image

class Ins(Ports):
    image: Image[Array, "H W"]

class Outs(Ports):
    image: Image[Array, "H W"]

class Fail(Module[Params, Ins, Outs]):
    "Fails."
    name = "fail"
    def run(self, inputs, ctx):
        {body}

visint_contract = 1

@hookimpl
def visint_modules():
    return [Fail]
"""
ONE = """visint: 1
name: one
inputs: {image: Image}
nodes: {it: {uses: frail.fail, in: {image: inputs.image}}}
outputs: {image: it.image}
"""


class TestUsage:
    """2: the command line or the graph."""

    @pytest.mark.parametrize(
        ("arguments", "said"),
        [
            (["--light", "1,2,3", "--light-at", "1,2,3"], "exclude"),
            (["--disparity-range", "9"], "a,b"),
            (["--disparity-range", "9,3"], "a < b"),
            (["--disparity-range", "0,nan"], "a,b"),
            (["--in", "left"], "NAME=PATH"),
            (["--in", "left="], "NAME=PATH"),
            (["--set", "match"], "NODE.PARAM=VALUE"),
            (["--set", "match.nope=1"], "nope"),
            (["--set", "nope.speckle=1"], "match"),
            (["--set", "match.speckle=-1"], "greater than"),
            (["--set", "match.speckle={"], "VI1"),
            (["--without", "stereo"], "spoke"),
            (["--control", "dark"], "control"),
            (["--stop-after", "mach"], "match"),
            (["--gamma", "nan"], "gamma"),
            (["--gamma", "-1"], "gamma"),
            (["--gamma", "0"], "gamma"),
            (["--threads", "0"], "--threads"),
            (["--seed", "x"], "--seed"),
            (["--from", "."], "hub"),
            (["--nope"], "--nope"),
        ],
        ids=" ".join,
    )
    def test_option(self, refused, pair, arguments, said):
        assert said in refused(2, "run", "stereo_sgm", *pair.all, "--out", "out", *arguments)

    def test_graph_name(self, refused, pair):
        assert "stereo_sgm" in refused(2, "run", "stereo_smg", *pair.all, "--out", "out")

    def test_graph_file(self, refused, pair, tmp_path):
        (tmp_path / "bad.yaml").write_text(
            "visint: 1\nname: bad\nnodes:\n  a: {uses: stereo.smg}\noutputs: {d: a.d}\n"
        )
        assert "bad.yaml:4:" in refused(2, "run", "bad.yaml", *pair.all, "--out", "out")
        assert "bad.yaml:4:" in refused(2, "check", "bad.yaml")
        assert "bad.yaml:4:" in refused(2, "show", "bad.yaml")

    def test_two_files_for_one_image(self, refused, pair):
        said = refused(2, "run", "stereo_sgm", *pair.all, "--in", f"left={pair.right}", "--out", "out")
        assert "'left' is one Image; 2 files" in said

    def test_out_is_wanted(self, refused, pair):
        assert "--out" in refused(2, "run", "stereo_sgm", *pair.all)

    def test_light(self, refused, toys, tmp_path):
        (tmp_path / "g.yaml").write_text(
            "visint: 1\nname: g\ninputs: {light: Light, a: Scalar}\n"
            "nodes: {n: {uses: toy.add, in: {a: inputs.a, b: inputs.a}}}\noutputs: {n: n.sum}\n"
        )
        for light in ("1,2", "0,0,0", "a,b,c", "0,0,inf"):
            said = refused(2, "run", "g.yaml", "--in", "a=1", "--light", light, "--out", "out")
            assert "light" in said


def spoilt(kind, tmp_path, pair):
    """(left image, calibration) of which one is spoilt as ``kind`` says, and what must be said."""
    left, calib = tmp_path / "left.png", tmp_path / "calib.txt"
    whole = (pair.folder / "left.png").read_bytes()
    left.write_bytes(whole)
    match kind:
        case "missing":
            left.unlink()
        case "empty":
            left.write_bytes(b"")
        case "truncated":
            left.write_bytes(whole[: len(whole) // 2])
        case "text":
            left.write_text("left image")
        case "folder":
            left.unlink()
            left.mkdir()
        case "lying header":
            left.write_bytes(whole[:16] + (200_000).to_bytes(4, "big") * 2 + whole[24:])
        case "pipe":
            left.unlink()
            os.mkfifo(left)
    return left, calib


class TestInputs:
    """3: images and calibrations."""

    @pytest.mark.parametrize(
        "kind", ["missing", "empty", "truncated", "text", "folder", "lying header", "pipe"]
    )
    def test_image(self, visint, pair, tmp_path, kind):
        left, _ = spoilt(kind, tmp_path, pair)
        done = visint("run", "stereo_sgm", "--left", left, "--right", pair.right, "--out", "out")
        assert done.code == 3
        assert done.out == ""
        assert "left.png" in done.err
        assert len(done.err.splitlines()) <= 3
        assert not (tmp_path / "out").exists()

    def test_all_at_once(self, refused, pair):
        """Both images and the calibration are wrong: one call tells all three, and what is missing."""
        inputs = ["--left", "no-left.png", "--calib", "no-calib.txt", "--in", "nope=x.png"]
        said = refused(3, "run", "stereo_sgm", *inputs, "--out", "out")
        assert all(one in said for one in ("no-left.png", "no-calib.txt", "'nope'", "--right PATH"))

    def test_images_of_different_sizes(self, refused, pair, tmp_path):
        """It is the input's fault, not the module's; both sizes are named."""
        cv2.imwrite(str(tmp_path / "small.png"), cv2.imread(pair.right)[:40])
        said = refused(3, "run", "stereo_sgm", "--left", pair.left, "--right", "small.png", "--out", "out")
        assert said.startswith("VI307")
        assert "64 × 48 and 64 × 40" in said

    @pytest.mark.parametrize(
        ("changed", "said"),
        [
            ({"width": 128, "height": 96}, "128 × 96"),
            ({"width": None}, "width"),
            ({"baseline": -3}, "baseline"),
            ({"cam0": "[100 0; 0 100]"}, "cam0"),
            ({"cam0": "[nan 0 1; 0 1 1; 0 0 1]"}, "cam0"),
            ({"ndisp": "many"}, "ndisp"),
        ],
        ids=lambda one: next(iter(one), "") if isinstance(one, dict) else "",
    )
    def test_calibration(self, refused, pair, tmp_path, files, changed, said):
        (tmp_path / "c.txt").write_text(files.calibration(**changed))
        told = refused(3, "run", "stereo_sgm", *pair.images, "--calib", "c.txt", "--out", "out")
        assert said in told
        assert "VI30" in told

    def test_calibration_that_is_an_image(self, refused, pair):
        assert "VI30" in refused(3, "run", "stereo_sgm", *pair.images, "--calib", pair.left, "--out", "out")

    def test_light_where_none_is_wanted(self, refused, pair):
        said = refused(3, "run", "stereo_sgm", *pair.images, "--light", "0,0,-1", "--out", "out")
        assert "no input 'light'" in said


@pytest.fixture
def frail(tmp_path, request):
    """A plugin whose only module does what the test's parameter says."""
    text = BROKEN.format(body=request.param)
    (tmp_path / "one.yaml").write_text(ONE)
    with installed("frail-plugin", plugins={"frail": "frail"}, files={"frail/__init__.py": text}):
        yield


class TestModule:
    """4: a module of somebody's plugin."""

    @pytest.mark.parametrize(
        "frail",
        [
            "raise ZeroDivisionError('no light')",
            "raise SystemExit(0)",
            "raise ValueError(inputs.image)",
            "inputs.image[0] = 1",
            "return None",
            "return Outs(image=inputs.image[:3])",
            "import numpy; return Outs(image=inputs.image.astype(numpy.float64))",
            "import visint.errors; raise visint.errors.InputError.of('VI302', 'mine')",
        ],
        indirect=True,
    )
    def test_failing(self, visint, frail, pair, tmp_path, request):
        """Named with node, module, distribution, level and turn; an array in its message is cut short."""
        done = visint("run", "one.yaml", "--in", f"image={pair.left}", "--out", "out")
        assert done.out == ""
        assert len(done.err.splitlines()) <= 3
        assert len(done.err) < 1000
        assert "Traceback" not in done.err
        assert not (tmp_path / "out").exists()
        if "InputError" not in request.node.name:
            assert done.code == 4
            assert all(one in done.err for one in ("'it'", "frail.fail", "frail-plugin 1.0", "level 0"))

    @pytest.mark.parametrize("frail", ["raise ZeroDivisionError('no light')"], indirect=True)
    def test_debug_shows_the_traceback(self, visint, frail, pair):
        """Wherever it stands; the exit code stays."""
        inputs = ["--in", f"image={pair.left}", "--out", "out"]
        for arguments in (["--debug", "run", "one.yaml", *inputs], ["run", "one.yaml", *inputs, "--debug"]):
            done = visint(*arguments)
            assert done.code == 4
            assert "Traceback" in done.err
            assert "ZeroDivisionError: no light" in done.err

    def test_plugin_that_does_not_import(self, visint, tmp_path, pair):
        (tmp_path / "one.yaml").write_text(ONE)
        with installed("frail-plugin", plugins={"frail": "frail"}, files={"frail.py": "import nothing_at_all"}):
            done = visint("run", "one.yaml", "--in", f"image={pair.left}", "--out", "out")
        assert done.code in (2, 4)
        assert "frail-plugin 1.0" in done.err
        assert "Traceback" not in done.err

    def test_our_own_fault(self, visint, monkeypatch, pair):
        """What nobody foresaw is one line too, and says how to see it whole."""

        def broken(*arguments, **options):
            raise RuntimeError("x" * 10_000)

        monkeypatch.setattr("visint.engine.sources.read_sources", broken)
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out")
        assert done.code == 4
        assert "--debug" in done.err
        assert len(done.err) < 500


class TestDisk:
    """5: what cannot be written."""

    @pytest.mark.parametrize("out", ["file", "file/below", "/proc/nowhere/out", "x" * 300])
    def test_no_folder(self, visint, pair, tmp_path, out):
        (tmp_path / "file").write_text("")
        done = visint("run", "stereo_sgm", *pair.all, "--out", out)
        assert done.code == 5
        assert done.out == ""
        assert done.err.startswith("VI60")
        assert (tmp_path / "file").read_text() == ""

    def test_unwritable_folder_is_refused_before_the_work(self, refused, pair, tmp_path, monkeypatch):
        """As ``os.access`` tells, for a test may be run by root."""
        (tmp_path / "locked").mkdir()
        monkeypatch.setattr("os.access", lambda path, mode: "locked" not in str(path))
        monkeypatch.setattr("visint.engine.sources.read_sources", None)
        assert "locked" in refused(5, "run", "stereo_sgm", *pair.all, "--out", "locked/out")
        assert "locked" in refused(5, "run", "stereo_sgm", *pair.all, "--out", "locked")
        assert "locked" in refused(5, "run", "stereo_sgm", *pair.all, "--out", "o", "--trace", "locked/t.json")

    def test_trace_without_a_folder_is_refused_before_the_work(self, refused, pair, monkeypatch):
        monkeypatch.setattr("visint.engine.sources.read_sources", None)
        said = refused(5, "run", "stereo_sgm", *pair.all, "--out", "out", "--trace", "no/t.json")
        assert "create it" in said

    @pytest.mark.parametrize("before", [False, True], ids=["new", "former run"])
    def test_full_disk_leaves_what_was(self, visint, pair, tmp_path, files, before, monkeypatch):
        """No space at the largest file: a former run stays as it was, a new folder does not appear."""
        if before:
            assert visint("run", "stereo_sgm", *pair.images, "--out", "out").code == 0
        was = files.contents(tmp_path)
        write = os.fsync

        def full(handle):
            if os.fstat(handle).st_size > 20_000:
                raise OSError(28, "No space left on device")
            write(handle)

        monkeypatch.setattr("os.fsync", full)
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out")
        assert done.code == 5
        assert done.out == ""
        assert "full" in done.err
        assert files.contents(tmp_path) == was
        assert (tmp_path / "out").exists() is before

    def test_file_size_limit(self, visint, pair, tmp_path):
        """``ulimit -f``: a message that names it, and no folder."""
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))
        try:
            done = visint("run", "stereo_sgm", *pair.all, "--out", "out")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        assert (done.code, done.out) == (5, "")
        assert "ulimit -f" in done.err
        assert not list(tmp_path.iterdir())


def test_done(visint, pair):
    """0, and the images need not be in a folder of their own."""
    assert visint("run", "stereo_sgm", *pair.all, "--out", "out").code == 0
    assert np.prod(cv2.imread(pair.left).shape[:2]) == 48 * 64
