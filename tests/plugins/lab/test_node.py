"""Rendering and measuring as nodes of a graph."""

import numpy as np
import pytest
from pydantic import ValidationError

import visint
from visint.testing import ModuleContract
from visint_lab.render.node import Render, RenderParams


class TestRender(ModuleContract):
    module = Render

    def make_params(self):
        return RenderParams(size=24, samples=1)


def test_a_scene_that_needs_files_or_is_unknown_is_no_parameter():
    """Modules open no file: Mozart is refused, with the scenes there are."""
    with pytest.raises(ValidationError, match="a/torus/lambertian"):
        RenderParams(scene="b/mozart/no")


def test_a_graph_renders_matches_and_measures():
    """One graph: a scene, a matcher, the error of its disparity; most visible pixels are right."""
    g = visint.Builder("measured", camera="Camera?")
    scene = g.add("scene", "lab.render", params={"size": 128, "samples": 2})
    match = g.add("match", "stereo.sgm", left=scene.left, right=scene.right, camera=scene.camera)
    score = g.add(
        "score", "lab.disparity_score", disparity=match.disparity, truth=scene.disparity, mask=scene.visible
    )
    result = visint.run(g.outputs(disparity=match.disparity, bad=score.bad2))
    assert result["bad"] < 0.1
    assert result["disparity"].dtype == np.float32
