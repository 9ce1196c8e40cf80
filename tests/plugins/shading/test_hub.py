"""The modules in graphs: as spokes of a hub, and as the page on shading wires them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import visint
from visint_lab.render.rendering import render
from visint_lab.scenes import scene

SPOKE = """
visint: 1
name: shading_as_a_spoke
inputs: {left: Image, right: Image, light: Light?, camera: Camera?}
loops: {sweeps: {times: 2}}
hub:
  loop: sweeps
  start: {depth: plane, boundaries: none}
  order: [stereo, shading]
  spokes:
    stereo: {uses: stereo.sgm}
    shading: {uses: shading.MODULE, in: {image: inputs.left}, reconcile: {uses: none}}
outputs: {depth: map.depth}
"""


@pytest.fixture(scope="module")
def seen():
    return render(scene("a/sphere/lambertian", 128), samples=2)


def given(seen):
    return {"left": seen.left, "right": seen.right, "camera": seen.camera, "light": seen.light}


@pytest.mark.parametrize("module", ["slope", "oliensis_dupuis", "incidence"])
def test_ports_bind_by_name(seen, tmp_path, module):
    """One line of YAML makes a spoke: depth, confidence and boundaries from the map, light and camera given."""
    path = tmp_path / "shading_as_a_spoke.yaml"
    path.write_text(SPOKE.replace("MODULE", module))
    result = visint.run(visint.load(str(path)), **given(seen))
    evidence = [name for name in result.evidence if name.startswith("shading")]
    assert evidence
    assert all(result.evidence[name].reliability.shape == seen.left.shape for name in evidence)


def test_the_page_s_graph_runs(seen, tmp_path):
    """As it stands there, with the true depth and regions."""
    page = Path(__file__).parents[3] / "docs/explanation/shading.md"
    text = re.search(r"```yaml\n(.*?)```", page.read_text(), re.DOTALL)[1]
    path = tmp_path / "shading_alone.yaml"
    path.write_text(text)
    regions = np.where(seen.truth.foreground, seen.truth.regions, 0).astype(np.int32)
    inputs = {"left": seen.left, "depth": seen.truth.depth, "regions": regions, "camera": seen.camera}
    result = visint.run(visint.load(str(path)), **inputs, light=visint.Light.unknown())
    normals = result["normals"]
    there = np.isfinite(normals[..., 2])
    cosine = (normals * seen.truth.normals).sum(axis=-1)[there & (seen.truth.normals[..., 2] < -0.35)]
    assert there[seen.truth.foreground].mean() > 0.7
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean() < 4
