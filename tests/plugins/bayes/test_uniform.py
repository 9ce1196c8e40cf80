"""The uniform hub as a whole: its policy, its graph, and a seventh module from a stranger's distribution."""

from __future__ import annotations

import numpy as np
import pytest

import visint
from visint.graph import alter, parse_graph
from visint.testing import installed
from visint_bayes.policy import UNIFORM
from visint_lab.datasets.pair import Pair
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_lab.trials.reconstruction import scored
from visint_lab.trials.systems import reconstruct


@pytest.fixture(scope="module")
def sphere():
    """A checkered sphere with 10 % noise, 96 × 96."""
    return render(scene("b/sphere/checker+10%", 96), seed=0)


def given(rendering, graph):
    offered = {name: getattr(rendering, name) for name in ("left", "right", "camera", "light")}
    return {name: value for name, value in offered.items() if name in graph.inputs}


def test_every_kind_of_evidence_has_its_steps():
    """All kinds that constrain a field of the map, and each step is a module of this plugin or built in."""
    from visint.fields.kinds import KINDS
    from visint_bayes import visint_modules

    known = {f"bayes.{module.name}" for module in visint_modules()} | {"none"}
    spoken = {name for name, kind in KINDS.items() if kind.constrains and name != "Regions"}
    assert spoken <= set(UNIFORM)
    assert {step["uses"] for steps in UNIFORM.values() for step in steps.values()} <= known


def test_the_graph_is_that_of_figure_5_13():
    """Coarse to fine from 8 pixels: seven levels at 512². Twenty sweeps, the order, five diffusions."""
    spec = visint.load("uniform_bayesian").spec
    assert spec.hub.uses == "bayes.uniform"
    assert tuple(spec.hub.order) == ("grouping", "diffusion", "stereo", "shading", "texture")
    assert spec.loops["levels"].coarsest == 8
    assert spec.loops["levels"].between == {"Depth": "quadratic"}
    assert spec.loops["sweeps"].times == 20
    assert spec.hub.spokes["diffusion"].with_ == {"iterations": 5}
    assert spec.hub.start["depth"] == "plane"
    assert spec.hub.start["boundaries"] in (None, "none")
    assert set(spec.controls) == {"shading", "texture"}
    assert spec.hub.spokes["stereo"].with_ == {"iterations": 1}


def test_integration_beats_the_same_stereo(sphere):
    """Shape by more than 30 %, as the trials of the corrected loop did; depth is not made worse."""
    pair = Pair.of(sphere)
    alone = scored(reconstruct("stereo", pair), pair)
    together = scored(reconstruct("uniform_bayesian", pair, sphere.light), pair)
    assert together["s"] < 0.7 * alone["s"]
    assert together["mse"] < 1.02 * alone["mse"]


def test_a_control_sets_every_step_of_its_cue():
    """Shading gives relief and normals; its control takes the amplitude of both."""
    graph = alter(visint.load("uniform_bayesian"), control="shading")
    steps = [name for name in graph.nodes if name.startswith("shading") and name.endswith("_reconcile")]
    assert len(steps) == 2
    assert {graph.nodes[name].params.alpha for name in steps} == {0.0}
    silent = alter(visint.load("uniform_bayesian"), without=["shading"])
    assert not any(name.startswith("shading") for name in silent.nodes)


STRANGER = {
    "visint_lidar/__init__.py": """
from visint.hookspecs import hookimpl


@hookimpl
def visint_modules():
    from visint_lidar.points import Points
    return [Points]
""",
    "visint_lidar/points.py": '''
import numpy as np

from visint.arrays import Array, Depth, Image
from visint.fields import DepthEvidence
from visint.module import Context, Module, Params, Ports


class PointsIn(Ports):
    image: Image[Array, "H W"]
    scan: Depth[Array, "H W"]


class PointsOut(Ports):
    points: DepthEvidence


class Points(Module[Params, PointsIn, PointsOut]):
    """Depth of a scan, as it is."""

    name = "points"
    assumptions = ("lidar.points_are_on_surfaces",)

    def run(self, inputs: PointsIn, ctx: Context) -> PointsOut:
        return PointsOut(points=DepthEvidence.of(inputs.scan, 0.3, 0.95))
''',
}


def test_a_seventh_module_takes_one_class_and_one_line(sphere):
    """A noisy scan: one spoke more in the file, no word to the hub or the core, and depth gets much better."""
    text = visint.load("uniform_bayesian").to_yaml()
    with installed("visint-lidar", plugins={"lidar": "visint_lidar"}, files=STRANGER):
        seventh = text.replace("camera: Camera?", "camera: Camera?\n  scan: Depth").replace(
            "  spokes:\n", "  spokes:\n    lidar: {uses: lidar.points, in: {image: inputs.left}}\n"
        )
        seventh = seventh.replace("shading, texture]", "shading, texture, lidar]")
        assert len(seventh.splitlines()) == len(text.splitlines()) + 2
        graph = parse_graph(seventh)
        noise = np.random.default_rng(0).normal(0, 0.3, sphere.left.shape)
        scan = (sphere.truth.depth + noise).astype(np.float32)
        with_it = visint.run(graph, {**given(sphere, graph), "scan": scan})
    plain = visint.load("uniform_bayesian")
    without_it = visint.run(plain, given(sphere, plain))
    on = sphere.truth.foreground
    errors = [np.square(found["depth"] - sphere.truth.depth)[on].mean() for found in (with_it, without_it)]
    assert errors[0] < 0.7 * errors[1]
    assert with_it.confidence["depth"][on].mean() > without_it.confidence["depth"][on].mean()
