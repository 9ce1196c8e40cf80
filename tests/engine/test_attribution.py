"""Which cue decided what: weights of every commit, followed by hand on toy hubs."""

from __future__ import annotations

import numpy as np
import pytest

from visint.arrays import Array, Confidence, Depth
from visint.engine import Options, run
from visint.fields import DepthEvidence
from visint.graph import parse_graph
from visint.module import Module, Params, Ports
from visint.testing.toys import Cue

TWO = """
inputs: {left: Image}
loops: {sweeps: {times: 3}}
hub:
  uses: toy.even
  loop: sweeps
  start: {depth: 2.0}
  order: [near, far]
  spokes:
    near: {uses: toy.cue, in: {image: inputs.left}, with: {near: 1.0, far: 1.0, reliability: 0.8}}
    far: {uses: toy.cue, in: {image: inputs.left}, with: {near: 3.0, far: 3.0, reliability: 0.6}}
outputs: {depth: map.depth}
"""

ASKED = Options(attribution=True)


def even(shape, value):
    return np.full(shape, value, np.float32)


class ListenIn(Ports):
    depth: Depth[Array, "H W"]
    evidence: tuple[DepthEvidence, ...]


class ListenOut(Ports):
    depth: Depth[Array, "H W"]
    depth_weights: tuple[Confidence[Array, "H W"], ...]


class Listen(Module[Params, ListenIn, ListenOut]):
    """Says what it weighed: 0.7 for the first, 0.1 for any other."""

    name = "listen"

    def run(self, inputs, ctx):
        ctx.check()
        shape = inputs.depth.shape
        weights = tuple(even(shape, 0.7 if i == 0 else 0.1) for i, _ in enumerate(inputs.evidence))
        left = 1 - sum(weights)
        said = sum(weight * one.value for weight, one in zip(weights, inputs.evidence, strict=True))
        return ListenOut(depth=(left * inputs.depth + said).astype(np.float32), depth_weights=weights)


class TestByHand:
    def test_weights_follow_every_commit(self, stage, image):
        """Blends of 0.4 and 0.3 in turn: the weights of the linear combination that the depth is."""
        result = stage.run(TWO, {"left": image}, attribution=True)
        near, far = 0.0, 0.0
        for _ in range(3):
            near = near * 0.6 + 0.4
            near, far = near * 0.7, far * 0.6 * 0.7 + 0.3
        found = result.attribution["depth"]
        assert set(found) == {"near", "far"}
        np.testing.assert_allclose(found["near"], near, rtol=1e-4)
        np.testing.assert_allclose(found["far"], far, rtol=1e-4)
        combined = found["near"] * 1 + found["far"] * 3 + (1 - found["near"] - found["far"]) * 2
        np.testing.assert_allclose(result["depth"], combined, rtol=1e-4)
        assert all(not one.flags.writeable for one in found.values())

    def test_what_is_replaced_is_decided_whole(self, stage, image):
        """A hub without a policy: the cue takes the map's place where it speaks; elsewhere the start stays."""
        text = """
inputs: {left: Image, edges: Boundaries}
hub:
  start: {depth: 7.0}
  order: [cue]
  spokes: {cue: {uses: toy.cue, in: {image: inputs.left, boundaries: inputs.edges}}}
outputs: {depth: map.depth}
"""
        edges = image > 0.5
        result = stage.run(text, {"left": image, "edges": edges}, attribution=True)
        np.testing.assert_array_equal(result.attribution["depth"]["cue"], (~edges).astype(np.float32))

    def test_boundaries_of_a_map_that_had_none(self, stage, image):
        """All of a field that had no start is decided by the one who brings it."""
        text = """
inputs: {left: Image}
hub:
  order: [edges]
  spokes: {edges: {uses: toy.boundary_cue, in: {image: inputs.left}}}
outputs: {boundaries: map.boundaries}
"""
        result = stage.run(text, {"left": image}, attribution=True)
        np.testing.assert_array_equal(result.attribution["boundaries"]["edges"], 1)

    def test_who_leaves_the_map_alone_decides_nothing(self, stage, image):
        """`reconcile: none` and amplitude 0: no weight at all."""
        text = TWO.replace("reliability: 0.6}}", "reliability: 0.6}, reconcile: {with: {alpha: 0.0}}}")
        found = stage.run(text, {"left": image}, attribution=True).attribution["depth"]
        assert not found["far"].any()
        np.testing.assert_allclose(found["near"], 1 - 0.6**3, rtol=1e-4)


class HalveIn(Ports):
    depth: Depth[Array, "H W"]


class Halve(Module[Params, HalveIn, Cue.Outputs]):
    """Half of the map's depth, as evidence: it knows nothing but the map."""

    name = "halve"

    def run(self, inputs, ctx):
        ctx.check()
        depth = inputs.depth / 2
        return Cue.Outputs(evidence=DepthEvidence.of(depth, 0.1, 1.0), sharpness=depth)


def test_who_knows_nothing_but_the_map_has_no_weight(stage, image):
    """What a spoke makes of the map stays theirs who brought it, however far it moves the map."""
    stage.modules(own=[Halve])
    text = TWO.replace("order: [near, far]", "order: [near, far, halve]")
    text = text.replace("outputs:", "    halve: {uses: own.halve}\noutputs:")
    found = stage.run(text, {"left": image}, attribution=True).attribution["depth"]
    alone = stage.run(TWO, {"left": image}, attribution=True).attribution["depth"]
    assert set(found) == {"near", "far"}
    for cue, share in alone.items():
        np.testing.assert_allclose(found[cue], share, rtol=1e-4)


class TestAllEvidenceAtOnce:
    JOINT = TWO.replace("  spokes:\n", "  reconcile: {depth: {uses: USES}}\n  spokes:\n").replace(
        "times: 3", "times: 1"
    )

    def test_a_reconciler_may_say_it_itself(self, stage, image):
        """A plain port `depth_weights`, one map for each evidence in order."""
        stage.modules(own=[Listen])
        result = stage.run(self.JOINT.replace("USES", "own.listen"), {"left": image}, attribution=True)
        found = result.attribution["depth"]
        np.testing.assert_allclose(found["near"], 0.7)
        np.testing.assert_allclose(found["far"], 0.1, rtol=1e-6)
        np.testing.assert_allclose(result["depth"], 0.7 * 1 + 0.1 * 3 + 0.2 * 2, rtol=1e-6)

    def test_else_it_is_seen_from_how_the_map_moved(self, stage, image):
        """The mean weighted 0.8 : 0.6 is 13/7: a seventh of the way to the near cue, away from the far one."""
        result = stage.run(self.JOINT.replace("USES", "toy.joint"), {"left": image}, attribution=True)
        found = result.attribution["depth"]
        np.testing.assert_allclose(found["near"], 1 / 7, rtol=1e-4)
        np.testing.assert_array_equal(found["far"], 0)


class TestLevels:
    HUB = """
inputs: {left: Image, right: Image, camera: Camera}
loops:
  levels: {over: pyramid, coarsest: 8}
  sweeps: {inside: levels, times: 4}
hub:
  uses: toy.even
  loop: sweeps
  order: [edges, shade, match]
  spokes:
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}}
    shade: {uses: toy.cue, in: {image: inputs.left}, with: {near: 700.0, far: 900.0}, levels: [1, 2]}
    match: {uses: toy.disparity_cue, in: {image: inputs.right}}
outputs: {depth: map.depth, boundaries: map.boundaries}
"""

    def test_weights_go_from_level_to_level(self, stage, camera):
        """A cue of coarse levels alone keeps what the finest has not overruled; all shares are at most 1."""
        image = np.random.default_rng(5).uniform(0.2, 0.8, (24, 31)).astype(np.float32)
        given = {"left": image, "right": image, "camera": camera((24, 31))}
        result = stage.run(self.HUB, given, attribution=True)
        depth = result.attribution["depth"]
        assert set(depth) == {"shade", "match"}
        assert set(result.attribution["boundaries"]) == {"edges"}
        total = depth["shade"] + depth["match"]
        assert total.shape == (24, 31)
        assert (total <= 1 + 1e-6).all()
        assert 0 < depth["shade"].mean() < 0.1
        assert depth["match"].mean() > 0.9

    def test_threads_give_the_same_bits(self, stage, camera):
        image = np.random.default_rng(6).uniform(0.2, 0.8, (24, 31)).astype(np.float32)
        given = {"left": image, "right": image, "camera": camera((24, 31))}
        alone = stage.run(self.HUB, given, attribution=True).attribution
        many = stage.run(self.HUB, given, attribution=True, threads=3).attribution
        for name, weights in alone.items():
            for cue, one in weights.items():
                np.testing.assert_array_equal(one, many[name][cue])


class TestAsking:
    def test_nobody_asks(self, stage, image):
        assert stage.run(TWO, {"left": image}).attribution == {}

    def test_nothing_to_tell_without_a_map(self):
        text = "visint: 1\nname: a\nnodes: {one: {uses: toy.constant}}\noutputs: {value: one.value}\n"
        import visint.testing.plugin
        from visint.registry import Catalog

        graph = parse_graph(text, Catalog({"toy": visint.testing.plugin}))
        assert run(graph, options=ASKED).attribution == {}

    def test_the_hub_spelled_out_tells_the_same(self, stage, image):
        """`of:` keeps the attribution when a hub is expanded."""
        hub = stage.graph(TWO)
        plain = parse_graph(hub.expanded(), hub.catalog)
        one, other = (run(graph, {"left": image}, options=ASKED).attribution for graph in (hub, plain))
        assert one["depth"].keys() == other["depth"].keys()
        for cue in one["depth"]:
            np.testing.assert_array_equal(one["depth"][cue], other["depth"][cue])


@pytest.fixture
def camera():
    from visint.testing.samples import sample_camera

    return sample_camera
