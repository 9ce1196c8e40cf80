"""What is said where a newcomer goes wrong: the file that it is about, and the next thing to try."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest


def test_a_missing_graph_file_is_called_one(refused, pair, tmp_path):
    """Without a line that there is not; a near name is offered."""
    (tmp_path / "mine.yaml").write_text("visint: 1\n")
    said = refused(2, "check", "./mien.yaml")
    assert said.startswith("VI101 mien.yaml: there is no such graph file")
    assert "the folder has 'mine.yaml'" in said
    assert "Write:" in said


@pytest.mark.parametrize("option", ["graph", "calib", "record"])
def test_an_image_where_a_text_is_wanted(refused, pair, tmp_path, option):
    """It is told as what it is, however large it is."""
    image = (pair.folder / "left.png").read_bytes()
    image = image[:33] + bytes(300_000) + image[33:]
    for size in (image, image[:5_000]):
        (tmp_path / "x.png").write_bytes(size)
        (tmp_path / "run.json").write_bytes(size)
        arguments = {
            "graph": (2, "check", "./x.png"),
            "calib": (3, "run", "stereo_sgm", *pair.images, "--calib", "x.png", "--out", "out"),
            "record": (3, "run", "run.json", "--out", "out"),
        }[option]
        assert "is a PNG file, not text" in refused(*arguments)


def test_a_text_file_where_numbers_are_wanted(refused, tmp_path, toys):
    """Not taken for an image: how to make the file that is read."""
    (tmp_path / "g.yaml").write_text(
        "visint: 1\nname: g\ninputs: {x: Scalars}\nnodes: {n: {uses: toy.constant}}\noutputs: {x: inputs.x}\n"
    )
    (tmp_path / "x.txt").write_text("1\n2\n3\n")
    said = refused(3, "run", "g.yaml", "--in", "x=x.txt", "--out", "out")
    assert "is text; a Scalars is read from npy, npz" in said
    assert "numpy.loadtxt" in said


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("match.speckle=-1", "VI205 match.speckle=-1: found -1; should be greater than or equal to 0"),
        ("match.speckel=5", "Write: match.speckle=5"),
    ],
)
def test_a_wrong_setting_is_told_as_the_setting(refused, pair, setting, said):
    """Not as a line of a file that ships with visint, where it does not stand."""
    told = refused(2, "run", "stereo_sgm", *pair.all, "--out", "out", "--set", setting)
    assert said in told
    assert ".yaml" not in told


@pytest.mark.parametrize(
    ("typed", "meant"), [("sgm", "stereo.sgm"), ("stero.sgm", "stereo.sgm"), ("stereo.sgn", "stereo.sgm")]
)
def test_a_module_that_is_nearly_named(refused, typed, meant):
    """Also by its last word alone."""
    assert f"Write: visint modules {meant}" in refused(2, "modules", typed)


def test_no_module_is_near(refused):
    """Then it is said where they all stand."""
    assert "Write: visint modules   (all" in refused(2, "modules", "qqq")


def test_a_guessed_focal_length_is_told(visint, pair):
    """Depth from it would be taken for measured."""
    done = visint("run", "stereo_sgm", *pair.images, "--disparity-range", "0,9", "--out", "out")
    assert "a focal length of 64 pixels is a guess" in done.err


def test_an_output_that_nobody_wrote_is_told(visint, pair, tmp_path, toys):
    """No spoke gives boundaries: the file is missing, and that is said."""
    (tmp_path / "hub.yaml").write_text(
        "visint: 1\nname: hub\ninputs: {left: Image}\nloops: {sweeps: {times: 1}}\n"
        "hub: {uses: toy.even, loop: sweeps, start: {depth: 5.0}, order: [a], spokes: {a: {uses: toy.cue, "
        "in: {image: inputs.left}}}}\noutputs: {depth: map.depth, boundaries: map.boundaries}\n"
    )
    done = visint("run", "hub.yaml", "--left", pair.left, "--out", "out")
    assert done.code == 0
    assert "warning: outputs.boundaries: nothing wrote it" in done.err
    assert not (tmp_path / "out/boundaries.png").exists()


def test_a_pyramid_in_a_graph_called_inside_a_pyramid(refused, tmp_path, monkeypatch):
    """Levels inside levels have no meaning, wherever the inner one stands."""
    from visint.registry import catalog

    inner = "visint: 1\nname: inner\ninputs: {x: Image}\nloops: {levels: {over: pyramid, levels: 2}}\n"
    inner += (
        "nodes: {m: {uses: texture.moments, loop: levels, in: {image: inputs.x}}}\noutputs: {m: m.texture}\n"
    )
    (tmp_path / "inner.yaml").write_text(inner)
    found = catalog._graph_files()
    monkeypatch.setattr(catalog, "_graph_files", lambda: {**found, "inner": {"test": tmp_path / "inner.yaml"}})
    catalog._installed.cache_clear()
    (tmp_path / "outer.yaml").write_text(
        "visint: 1\nname: outer\ninputs: {x: Image}\nloops: {outer: {over: pyramid, levels: 2}}\n"
        "nodes: {c: {uses: 'graph:inner', loop: outer, in: {x: inputs.x}}}\noutputs: {m: c.m}\n"
    )
    said = refused(2, "check", "outer.yaml")
    catalog._installed.cache_clear()
    assert "VI217 outer.yaml:5:" in said
    assert "graph:inner has a pyramid of its own, 'levels', and is called inside 'outer'" in said


def test_stopping_after_a_node_gives_its_ports(visint, pair, tmp_path):
    """Under their own names, beside what the graph has given by then; the run can be repeated."""
    done = visint(
        "run", "stereo", *pair.images, "--disparity-range", "0,9", "--stop-after", "attributes", "--out", "o"
    )
    assert done.code == 0, done
    with np.load(tmp_path / "o/attributes_images_1.npz") as stored:
        assert stored["attributes_images_1"].shape == (48, 64, 4)
    assert visint("run", "o/run.json", "--out", "again").code == 0


def test_show_as_json(visint):
    """The order, loops and all, as data."""
    told = visint("show", "uniform_bayesian", "--json").json
    assert [item.get("node") or item["loop"] for item in told["order"]][:2] == ["attributes", "levels"]
    assert told["inputs"]["light"] == "Light?"


def test_a_module_without_inputs_of_its_own_is_sound(visint, tmp_path):
    """``Module[Params, Ports, Outs]``: nothing to take is nothing to declare."""
    from visint.testing import installed

    text = '''"""A source."""
from visint.hookspecs import hookimpl
from visint.module import Module, Params, Ports

class Outs(Ports):
    """One number."""
    value: float

class Source(Module[Params, Ports, Outs]):
    """Gives 3."""
    name = "source"
    def run(self, inputs, ctx):
        return Outs(value=3.0)

visint_contract = 1

@hookimpl
def visint_modules():
    return [Source]
'''
    (tmp_path / "g.yaml").write_text(
        "visint: 1\nname: g\nnodes: {a: {uses: bare.source}}\noutputs: {value: a.value}\n"
    )
    with installed("bare-plugin", plugins={"bare": "bare"}, files={"bare.py": text}):
        assert visint("run", "g.yaml", "--out", "out").code == 0
    assert json.loads((tmp_path / "out/run.json").read_text())["outputs"]["value"]["value"] == 3.0


def test_a_light_given_in_python_is_repeated_from_the_record(visint, pair, tmp_path):
    """And so is a number: only arrays need a file."""
    import visint as package
    from visint import io
    from visint.cli.again import _spelled

    light = package.Light.distant(0.3, -0.2, -0.9)
    assert _spelled(light.model_dump(mode="json")).count(",") == 2
    assert package.Light.distant(*map(float, _spelled(light.model_dump(mode="json")).split(","))) == light
    images = {name: io.read_image(getattr(pair, name)) for name in ("left", "right")}
    result = package.run("stereo_sgm", images, camera=io.read_camera(pair.calib))
    result.save(tmp_path / "one", sources={"left": pair.left, "right": pair.right, "camera": pair.calib})
    assert visint("run", tmp_path / "one/run.json", "--out", "two").code == 0
    assert (tmp_path / "one/depth.pfm").read_bytes() == (tmp_path / "two/depth.pfm").read_bytes()
    shutil.rmtree(tmp_path / "two")
    assert np.isfinite(result["depth"]).any()
