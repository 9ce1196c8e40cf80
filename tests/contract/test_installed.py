"""The rest of the kit: fake installations, the toy plugin in the registry and in graphs, samples, lightness."""

from __future__ import annotations

import importlib
import subprocess
import sys
from importlib.metadata import entry_points, version
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

import visint
from visint.errors import GraphError, ModuleError, PluginError
from visint.fields import KINDS, Camera, Evidence
from visint.module import Ports
from visint.names import ModuleId
from visint.registry import Catalog
from visint.testing import installed, sample_inputs, strategies, toys
from visint.testing.samples import CAN_BE_UNKNOWN, evidence_class


def names(group="visint.plugins"):
    return {point.name for point in entry_points(group=group)}


class TestInstalled:
    def test_within_the_block_it_is_installed(self):
        """As importlib.metadata and the import system see it; afterwards nothing is left."""
        files = {"one_thing/__init__.py": "answer = 42\n", "one_thing/deep/data.txt": "x"}
        before = list(sys.path)
        with installed("one-thing", plugins={"one": "one_thing"}, files=files, version="2.1") as folder:
            assert version("one-thing") == "2.1"
            assert "one" in names()
            assert importlib.import_module("one_thing").answer == 42
            assert (folder / "one_thing/deep/data.txt").is_file()
        assert sys.path == before
        assert "one" not in names()
        assert "one_thing" not in sys.modules
        assert not folder.exists()

    def test_it_goes_away_after_an_error_too(self):
        with pytest.raises(RuntimeError), installed("one-thing", plugins={"one": "one_thing"}):
            raise RuntimeError
        assert "one" not in names()

    def test_other_groups(self):
        with installed("verbs", groups={"visint.commands": {"hum": "verbs:hum"}, "visint.graphs": {}}):
            assert "hum" in names("visint.commands")

    def test_two_that_claim_one_name_are_both_named(self):
        """The registry chooses neither."""
        with (
            installed("first", plugins={"toy": "visint.testing.plugin"}),
            installed("second", plugins={"toy": "visint.testing.plugin"}, version="3.0"),
            pytest.raises(PluginError, match=r"VI502.*first 1.0 and second 3.0"),
        ):
            Catalog().plugin("toy")

    def test_a_broken_one_stands_in_nobodys_way(self):
        """Its failure is told with its name; the toys load."""
        broken = {"broken_thing.py": "raise OSError('no licence')\n"}
        with (
            installed("broken", plugins={"broken": "broken_thing"}, files=broken),
            installed("toys", plugins={"toy": "visint.testing.plugin"}),
        ):
            catalog = Catalog()
            with pytest.raises(PluginError, match=r"VI501.*broken 1\.0.*OSError: no licence"):
                catalog.plugin("broken")
            assert catalog.module(ModuleId("toy", "add")) is toys.Add

    def test_a_new_process_sees_it_by_pythonpath(self):
        with installed("toys", plugins={"toy": "visint.testing.plugin"}) as folder:
            code = "from importlib.metadata import entry_points as e; print(e(group='visint.plugins').names)"
            done = subprocess.run(
                [sys.executable, "-c", code],
                env={"PYTHONPATH": str(folder)},
                capture_output=True,
                text=True,
                check=True,
            )
        assert "'toy'" in done.stdout


@pytest.fixture
def toy_plugin():
    with installed("toys", plugins={"toy": "visint.testing.plugin"}):
        yield Catalog().plugin("toy")


def run(text, folder, **inputs):
    """A graph given as text, with the toys installed."""
    path = Path(folder, "graph.yaml")
    path.write_text(f"visint: 1\nname: graph\n{text}", encoding="utf-8")
    return visint.run(visint.load(path), inputs)


class TestToysInGraphs:
    def test_every_toy_is_there(self, toy_plugin):
        assert set(toy_plugin.modules) == {toy.name for toy in toys.TOYS}

    def test_the_steps_of_the_policy_are_toys(self, toy_plugin):
        """Each step of `toy.even` names a toy, `none` or `replace`, and every kind has an answer."""
        even = toy_plugin.policies["even"]
        assert "*" in even
        for kind, steps in even.items():
            assert kind == "*" or kind in KINDS
            assert set(steps) == {"cohere", "reconcile"}
            for step in steps.values():
                plugin, _, name = step["uses"].rpartition(".")
                assert name in toy_plugin.modules if plugin else name in ("none", "replace")

    def test_fibonacci(self, toy_plugin, tmp_path):
        """Two feedback edges: 1, 2, 3, 5, 8, … and the tenth is 89."""
        graph = """
loops: {months: {times: 10}}
nodes:
  pairs: {uses: toy.add, loop: months, feedback: {a: {from: pairs.sum, start: 1}, b: {from: young.value}}}
  young: {uses: toy.delay, loop: months, feedback: {value: {from: pairs.sum, start: 1}}}
outputs: {pairs: pairs.sum}
"""
        graph = graph.replace("{from: young.value}", "{from: young.value, start: 0}")
        assert run(graph, tmp_path)["pairs"] == 89

    def test_a_failing_toy_is_named(self, toy_plugin, tmp_path):
        with pytest.raises(ModuleError, match=r"VI401.*broken.*the toy broke"):
            run("nodes: {broken: {uses: toy.fail}}\noutputs: {value: broken.value}\n", tmp_path)

    @pytest.mark.parametrize(
        ("toy", "said"),
        [
            ("toy.scribble", "read-only"),
            ("toy.wrong, with: {what: dtype}", "this array is float64"),
            ("toy.wrong, with: {what: size}", "H is 3 on port 'image' but 2 on port 'other'"),
        ],
    )
    def test_offenders_are_named(self, toy_plugin, tmp_path, toy, said):
        graph = f"inputs: {{image: Image}}\nnodes: {{odd: {{uses: {toy}, in: {{image: inputs.image}}}}}}\n"
        with pytest.raises(ModuleError, match=f"odd.*{said}"):
            run(graph + "outputs: {image: odd.image}\n", tmp_path, image=np.zeros((3, 4), np.float32))

    def test_a_toy_that_does_not_exist_has_a_near_miss(self, toy_plugin, tmp_path):
        with pytest.raises(GraphError, match=r"VI201.*'toy' has no module 'consant'"):
            run("nodes: {one: {uses: toy.consant}}\noutputs: {value: one.value}\n", tmp_path)


class TestSamples:
    @pytest.mark.parametrize("toy", toys.TOYS, ids=lambda toy: toy.name)
    def test_every_port_is_filled_and_equal_seeds_are_equal(self, toy):
        first, again = sample_inputs(toy.Inputs, (5, 7)), sample_inputs(toy.Inputs, (5, 7))
        assert all(value is not None for value in first.__dict__.values())
        assert repr(first) == repr(again)

    def test_another_seed_and_another_port_are_other_noise(self):
        inputs, other = (sample_inputs(toys.Smooth.Inputs, (5, 7), seed=seed) for seed in (0, 1))
        assert not np.array_equal(inputs.image, other.image)
        assert not np.array_equal(inputs.image, inputs.source)

    def test_lists_are_as_long_as_asked(self):
        """A module that wants a pair is given one."""
        assert len(sample_inputs(toys.Stack.Inputs, (5, 7), listed=2).images) == 2
        assert len(sample_inputs(toys.Stack.Inputs, (5, 7)).images) == 3

    def test_contents(self):
        ports = toys.Blend.Inputs
        assert sample_inputs(ports, (9, 9), "grey").depth.std() == 0
        holes = np.isnan(sample_inputs(ports, (9, 9), "holes").depth).mean()
        assert 0.1 < holes < 0.6
        unknown = sample_inputs(ports, (9, 9), "unknown")
        assert np.isnan(unknown.depth).all()
        assert not unknown.evidence.reliability.any()
        assert np.isfinite(unknown.depth_confidence).all()

    def test_every_kind_of_evidence_has_its_class(self):
        for kind in ("Depth", "Disparity", "Relief", "Normals", "Slopes", "Boundaries"):
            assert evidence_class(kind).measures == kind
        with pytest.raises(TypeError, match="no subclass of Evidence measures 'Text'"):
            evidence_class("Text")

    @pytest.mark.parametrize("kind", [kind.name for kind in KINDS.values() if kind.array])
    @given(data=strategies.st.data())
    def test_strategies_draw_what_the_kind_wants(self, kind, data):
        value = data.draw(strategies.arrays(kind))
        KINDS[kind].array.check(value)
        if value.dtype.kind == "f" and kind not in CAN_BE_UNKNOWN:
            assert np.isfinite(value).all()

    @given(strategies.cameras(), strategies.evidence("Slopes"))
    def test_cameras_and_evidence(self, camera, evidence):
        assert isinstance(camera, Camera)
        assert isinstance(evidence, Evidence)

    @given(data=strategies.st.data())
    def test_no_strategy_for_what_is_no_array(self, data):
        with pytest.raises(ValueError, match="Camera is no kind of array"):
            data.draw(strategies.arrays("Camera"))


def test_light_to_import():
    """The kit and the toys load neither pytest nor hypothesis, nor anything that calculates."""
    code = (
        "import sys, visint.testing, visint.testing.plugin as p; p.visint_modules();"
        "print([m for m in ('pytest', 'hypothesis', 'cv2', 'scipy', 'numba', 'networkx') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_toys_are_pairs_of_models():
    for toy in toys.TOYS:
        assert issubclass(toy.Inputs, Ports)
        assert issubclass(toy.Outputs, Ports)
        assert toy.Inputs.__doc__
        assert toy.run.__doc__
