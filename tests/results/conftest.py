"""Results of toy graphs, whose every number is known beforehand."""

from __future__ import annotations

import base64
import re
from types import SimpleNamespace

import numpy as np
import pytest

import visint
import visint.testing.plugin
from visint.graph import parse_graph
from visint.registry import Catalog
from visint.testing.samples import sample_camera

HUB = """
visint: 1
name: meeting
about: Two toy cues meet in the map.
inputs: {left: Image, right: Image, camera: Camera, light: Light?}
loops:
  levels: {over: pyramid, coarsest: 8}
  sweeps: {inside: levels, times: 12, until: {change_of: map.depth, below: 1.0e-3, patience: 2}}
nodes:
  seen: {uses: toy.counter}
  said: {uses: toy.warn, in: {value: seen.value}}
  measured: {uses: toy.measure, in: {value: said.value}}
hub:
  uses: toy.even
  loop: sweeps
  start: {depth: plane, boundaries: none}
  order: [edges, shade, match]
  spokes:
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}}
    shade: {uses: toy.cue, in: {image: inputs.left}, with: {near: 700.0, far: 900.0}}
    match: {uses: toy.disparity_cue, in: {image: inputs.right}}
outputs: {depth: map.depth, normals: map.normals, boundaries: map.boundaries, regions: map.regions,
  depth_confidence: map.depth_confidence, count: measured.value}
"""

CUE = """
visint: 1
name: cue
inputs: {image: Image, camera: Camera?}
nodes: {cue: {uses: toy.cue, with: {near: 1.0, far: 2.0, reliability: 0.5}, in: {image: inputs.image}}}
outputs: {depth: cue.evidence}
"""

SCALARS = """
visint: 1
name: scalars
nodes:
  one: {uses: toy.constant, with: {value: 2.5}}
outputs: {answer: one.value}
"""


def catalog(plugins=None, graphs=None):
    """The toys, and what else is given."""
    return Catalog({"toy": visint.testing.plugin, **(plugins or {})}, graphs or {})


def run(text, plugins=None, **inputs):
    """The result of the graph in ``text``; ``plugins`` come beside the toys."""
    return run_in(text, catalog(plugins), **inputs)


def run_in(text, where, **inputs):
    """The result of the graph in ``text``, names looked up in the catalog ``where``."""
    return visint.run(parse_graph(text, where), inputs)


def scene(rows, columns):
    """A bright disc on a wavy ground, float32 (rows, columns)."""
    y, x = np.mgrid[:rows, :columns].astype(np.float32)
    image = 0.4 + 0.2 * np.sin(x / 23) * np.cos(y / 31)
    image[(x - columns / 2) ** 2 + (y - rows / 2) ** 2 < (min(rows, columns) / 4) ** 2] += 0.3
    return np.clip(image, 0, 1).astype(np.float32)


def meeting(size=(48, 64)):
    image = scene(*size)
    return run(HUB, left=image, right=image * np.float32(0.9), camera=sample_camera(size))


def pictures(page):
    """(alt, RGB array) of each picture in a page, decoded."""
    import cv2

    found = []
    for tag in re.findall(r"<img [^>]*>", page):
        data = base64.b64decode(
            re.search(r'src="data:image/(?:png|jpeg);base64,([^"]*)"', tag)[1], validate=True
        )
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        found.append((re.search(r'alt="([^"]*)"', tag)[1], image[..., ::-1]))
    return found


@pytest.fixture(scope="session")
def toys():
    """Graphs as text, and what runs them and looks at their reports."""
    return SimpleNamespace(
        HUB=HUB,
        CUE=CUE,
        SCALARS=SCALARS,
        catalog=catalog,
        run=run,
        run_in=run_in,
        scene=scene,
        meeting=meeting,
        pictures=pictures,
        camera=sample_camera,
    )


@pytest.fixture(scope="session")
def met():
    """The result of a hub graph with loops, levels, evidence, a warning and a measure."""
    return meeting()
