"""The plain graph that a hub stands for runs to identical results, attribution included."""

from __future__ import annotations

import numpy as np
import pytest

HEAD = """
visint: 1
name: {name}
inputs: {{left: Image, right: Image, camera: Camera, light: Light?}}
loops:
  levels: {{over: pyramid, levels: 3, between: {{Depth: replicate}}}}
  sweeps: {{inside: levels, times: 4, until: {{change_of: map.depth, below: 1.0e-3}}}}
hub:
  {uses}loop: sweeps
"""

JOINT = (
    HEAD.format(name="joint", uses="uses: toy.even\n  ")
    + """  start: {depth: plane, boundaries: none}
  order: [edges, one, two, cue]
  spokes:
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}}
    one: {uses: toy.disparity_cue, in: {image: inputs.left}, at: {2: {disparity: 4.0}}}
    two: {uses: toy.disparity_cue, in: {image: inputs.right}, reconcile: {with: {alpha: 0.2}}}
    cue: {uses: toy.cue, in: {image: inputs.left}, levels: [0, 1], cohere: {uses: none}}
outputs: {depth: map.depth, normals: map.normals, boundaries: map.boundaries, sure: map.depth_confidence}
"""
)
TOGETHER = (
    HEAD.format(name="together", uses="")
    + """  start: {depth: 3.0}
  order: [a, b, edges]
  reconcile: {depth: {uses: toy.joint}}
  spokes:
    a: {uses: toy.cue, in: {image: inputs.left}, with: {sigma: 0.1}}
    b: {uses: toy.cue, in: {image: inputs.right}, with: {sigma: 0.2}, cohere: {uses: toy.cohere}}
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}}
outputs: {depth: map.depth, regions: map.regions, sure: map.depth_confidence, disparity: map.disparity}
"""
)
MONOCULAR = """
visint: 1
name: monocular
inputs: {left: Image}
loops: {sweeps: {times: 3}}
hub:
  loop: sweeps
  order: [cue]
  spokes: {cue: {uses: toy.cue, in: {image: inputs.left}, reconcile: {uses: toy.blend}}}
outputs: {depth: map.depth, sure: map.depth_confidence}
"""
STILL = """
visint: 1
name: still
inputs: {left: Image, camera: Camera}
nodes: {first: {uses: toy.cue, in: {image: inputs.left}}}
hub:
  start: {depth: first.evidence}
  order: [edges]
  spokes: {edges: {uses: toy.boundary_cue, in: {image: inputs.left}}}
outputs: {depth: map.depth, boundaries: map.boundaries, regions: map.regions}
"""
GRAPHS = {"joint": JOINT, "together": TOGETHER, "monocular": MONOCULAR, "still": STILL}


@pytest.fixture
def given(image, camera_for):
    right = np.roll(image, 1, axis=1)

    def make(graph):
        every = {"left": 0.5 + image / 2, "right": 0.5 + right / 2, "camera": camera_for(image)}
        return {name: value for name, value in every.items() if name in graph.inputs}

    return make


def assert_same(one, two):
    assert list(one) == list(two)
    for name in one:
        np.testing.assert_array_equal(one[name], two[name], err_msg=name)
    assert one.kinds == two.kinds
    assert one.writers == two.writers
    assert set(one.evidence) == set(two.evidence)
    for name, evidence in one.evidence.items():
        np.testing.assert_array_equal(evidence.value, two.evidence[name].value)
        np.testing.assert_array_equal(evidence.reliability, two.evidence[name].reliability)
    assert set(one.confidence) == set(two.confidence)
    for name, sure in one.confidence.items():
        np.testing.assert_array_equal(sure, two.confidence[name])
    assert (one.trace, one.stops) == (two.trace, two.stops)


@pytest.mark.parametrize("name", GRAPHS)
def test_runs_to_identical_results(stage, given, name):
    """Outputs, confidence, evidence, writers, trace, stops and calls: all the same bits."""
    hub = stage.graph(GRAPHS[name])
    plain = stage.graph(hub.expanded())
    assert plain.spec.hub is None
    one = stage.run(hub, given(hub))
    calls = stage.calls
    two = stage.run(plain, given(plain))
    assert stage.calls == calls
    assert_same(one, two)


@pytest.mark.parametrize("name", GRAPHS)
def test_starts_warm_alike(stage, given, name):
    hub = stage.graph(GRAPHS[name])
    plain = stage.graph(hub.expanded())
    start = {"depth": given(hub)["left"] * 5}
    assert_same(stage.run(hub, given(hub), start=start), stage.run(plain, given(plain), start=start))


@pytest.mark.parametrize(
    ("name", "spoke"), [("joint", "one"), ("joint", "cue"), ("together", "a"), ("joint", "edges")]
)
def test_without_a_spoke_alike(stage, given, name, spoke):
    """Leaving a spoke out of the hub, or out of its plain text, is the same."""
    from visint.graph import alter

    hub = stage.graph(GRAPHS[name])
    one = alter(hub, without=[spoke])
    two = alter(stage.graph(hub.expanded()), without=[spoke])
    assert_same(stage.run(one, given(hub)), stage.run(two, given(hub)))


class TestTogether:
    def test_a_field_is_reconciled_once_a_sweep_from_all_its_evidence(self, stage, given, image):
        """Weighted by r/σ²: 100 : 25 for σ = 0.1 and 0.2; edges in between do not matter."""
        graph = stage.graph(
            TOGETHER.replace("order: [a, b, edges]", "order: [a, b]").replace("    edges:", "    # edges:")
        )
        inputs = given(graph)
        result = stage.run(graph, inputs)
        near, far = 2 - inputs["left"], 2 - inputs["right"]
        np.testing.assert_allclose(result["depth"], (100 * near + 25 * far) / 125, rtol=1e-5)
        sweep = [name for name, level, turn in stage.calls if (level, turn) == (0, 0)]
        assert sweep[0] == "map_begin"
        assert sweep[-2:] == ["depth_reconcile", "map"]
        assert sorted(sweep[1:-2]) == ["a", "b", "b_cohere"]

    def test_is_written_by_the_reconciler(self, stage, given):
        """Who wrote depth is the field's own step, not a spoke."""
        graph = stage.graph(TOGETHER)
        result = stage.run(graph, given(graph))
        assert result.writers["depth"].node not in ("a", "b", "edges")
        assert result.writers["regions"].node == "edges"


def test_a_policys_steps_can_be_replaced_by_a_spoke(stage, given):
    """`reconcile: {with: …}` keeps the policy's module; `uses` puts another in its place."""
    graph = stage.graph(JOINT)
    assert graph.nodes["two_reconcile"].params.alpha == 0.2
    assert graph.nodes["one_reconcile"].params.alpha == 0.5
    assert "cue_cohere" not in graph.nodes
    assert {node.of for node in graph.nodes.values()} == {None, "edges", "one", "two", "cue"}


def test_a_map_from_outside_comes_down_to_the_levels(stage, image, camera_for):
    """A map that begins outside a pyramid is seen inside it at the level's size, with the level's camera."""
    text = """
inputs: {left: Image, camera: Camera}
loops: {levels: {over: pyramid, levels: 3}}
nodes:
  first: {uses: map.begin, with: {depth: 100.0}, in: {camera: inputs.camera}}
  see: {uses: toy.disparity_cue, loop: levels, in: {image: inputs.left}}
  blend: {uses: toy.blend_disparity, loop: levels,
          in: {depth: first.depth, evidence: see.evidence, camera: inputs.camera}}
  then: {uses: map.commit, loop: levels, in: {map: first.map, depth: blend.depth}}
outputs: {disparity: then.disparity, depth: then.depth}
"""
    result = stage.run(text, {"left": 0.5 + image / 2, "camera": camera_for(image)})
    np.testing.assert_allclose(result["depth"] * result["disparity"], 400, rtol=1e-5)
    assert result.writers["depth"].node == "then"
