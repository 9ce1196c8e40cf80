"""The hub: spokes in order around the map, what each sees, who wrote what, and how sure the map is."""

from __future__ import annotations

import numpy as np
import pytest

from visint.arrays import Array, Depth, Normals
from visint.engine import Options, run
from visint.errors import InputError
from visint.fields import DepthEvidence, geometry
from visint.fields.snapshot import Writer
from visint.module import Module, Params, Ports
from visint.results import Stop

ONE = """
inputs: {left: Image}
hub:
  order: [cue]
  spokes: {cue: {uses: toy.cue, in: {image: inputs.left}}}
outputs: {depth: map.depth, confidence: map.depth_confidence}
"""

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
outputs: {depth: map.depth, sure: map.depth_confidence}
"""


def blended(z, sure, target, share):
    return z + share * (target - z), sure + share * (1 - sure)


class TestOneSpoke:
    def test_without_a_loop_replaces_the_map(self, stage, image):
        """A hub without a policy and a loop: the evidence takes the map's place where it speaks, once."""
        result = stage.run(ONE, {"left": image})
        np.testing.assert_allclose(result["depth"], 2 - image, rtol=1e-6)
        np.testing.assert_array_equal(result["confidence"], np.ones_like(image))
        assert stage.calls == [("map_begin", 0, 0), ("cue", 0, 0), ("map", 0, 0)]
        assert result.writers["depth"] == Writer("cue", 0, 0)
        np.testing.assert_array_equal(result.evidence["cue"].value, result["depth"])

    def test_keeps_the_start_where_it_abstains(self, stage, image):
        """Where the cue is silent the map keeps its start and is not sure of it."""
        text = """
inputs: {left: Image, edges: Boundaries}
hub:
  start: {depth: 7.0}
  order: [cue]
  spokes: {cue: {uses: toy.cue, in: {image: inputs.left, boundaries: inputs.edges}}}
outputs: {depth: map.depth, sure: map.depth_confidence}
"""
        edges = image > 0.5
        result = stage.run(text, {"left": image, "edges": edges})
        np.testing.assert_array_equal(result["depth"][edges], 7)
        np.testing.assert_array_equal(result["sure"], (~edges).astype(np.float32))

    def test_reconcile_none_leaves_the_map_alone(self, stage, image):
        """The built-in `none`: the evidence is kept for the record, and never enters."""
        result = stage.run(
            ONE.replace("in: {image: inputs.left}}", "in: {image: inputs.left}, reconcile: {uses: none}}"),
            {"left": image},
        )
        np.testing.assert_allclose(result["depth"], 10, rtol=1e-6)
        np.testing.assert_array_equal(result["confidence"], 0)
        assert set(result.evidence) == {"cue"}
        assert result.writers == {}

    def test_monocular_without_a_camera(self, stage):
        """No camera: the map is relative, disparity and normals follow from a stand-in of the images' size."""
        text = ONE.replace("{left: Image}\n", "{left: Image, camera: Camera?}\n").replace(
            "depth: map.depth,", "depth: map.depth, disparity: map.disparity, normals: map.normals,"
        )
        image = np.linspace(0.4, 0.6, 13 * 21, dtype=np.float32).reshape(21, 13)
        result = stage.run(text, {"left": image})
        np.testing.assert_allclose(result["disparity"], image.shape[1] / (2 - image), rtol=1e-5)
        np.testing.assert_allclose(np.linalg.norm(result["normals"], axis=-1), 1, rtol=1e-5)
        assert (result["normals"][..., 2] < 0).all()
        assert not result.inputs["camera"]

    def test_needs_a_size(self, stage):
        with pytest.raises(Exception, match=r"VI402.*a map needs an image"):
            stage.run("""
inputs: {x: Scalar?}
hub: {order: [], spokes: {}}
outputs: {depth: map.depth}
""")


class TestTwoSpokes:
    def test_each_sees_what_those_before_it_committed(self, stage, image):
        """Blends of ½ in turn, near (r = 0.8) before far (r = 0.6), three sweeps: followed by hand."""
        result = stage.run(TWO, {"left": image})
        z, sure = 2.0, 0.0
        for _ in range(3):
            z, sure = blended(z, sure, 1.0, 0.4)
            z, sure = blended(z, sure, 3.0, 0.3)
        np.testing.assert_allclose(result["depth"], z, rtol=1e-5)
        np.testing.assert_allclose(result["sure"], sure, rtol=1e-5)
        sweep = ["map_begin", "near", "near_cohere", "near_reconcile", "map_near"]
        sweep += ["far", "far_cohere", "far_reconcile", "map"]
        assert stage.calls == [(name, 0, turn) for turn in range(3) for name in sweep]

    def test_order_matters(self, stage, image):
        result = stage.run(TWO.replace("order: [near, far]", "order: [far, near]"), {"left": image})
        z, sure = 2.0, 0.0
        for _ in range(3):
            z, sure = blended(z, sure, 3.0, 0.3)
            z, sure = blended(z, sure, 1.0, 0.4)
        np.testing.assert_allclose(result["depth"], z, rtol=1e-5)
        assert result.writers["depth"] == Writer("near", 0, 2)

    def test_a_spoke_reads_the_map_as_it_is_then(self, stage, image):
        """A spoke between two others sees depth after the first and before the third."""
        stage.modules(own=[Witness])
        text = TWO.replace("order: [near, far]", "order: [near, seen, far]").replace(
            "    far: {uses", "    seen: {uses: own.witness, reconcile: {uses: none}}\n    far: {uses"
        )
        result = stage.run(text, {"left": image})
        z, sure, wanted = 2.0, 0.0, []
        for _ in range(3):
            z, sure = blended(z, sure, 1.0, 0.4)
            wanted.append(z)
            z, sure = blended(z, sure, 3.0, 0.3)
        assert [measure.value for measure in result.measures] == pytest.approx(wanted, rel=1e-5)

    def test_sweeps_stop_when_the_map_is_still(self, stage, image):
        """`until: {change_of: map.depth}` ends the sweeps; warnings and stops name the loop."""
        text = TWO.replace("times: 3", "times: 99, until: {change_of: map.depth, below: 1.0e-3, patience: 2}")
        result = stage.run(text, {"left": image})
        z, changes = 2.0, []
        while len(changes) < 3 or max(changes[-2:]) >= 1e-3:
            before = z
            z = blended(blended(z, 0, 1.0, 0.4)[0], 0, 3.0, 0.3)[0]
            changes.append(abs(z - before) / z)
        assert result.stops == [Stop("sweeps", 0, len(changes), "converged")]

    def test_two_stereo_spokes_of_disparity(self, stage, image, camera_for):
        """Evidence on disparity enters a map of depth by Z = fB/d, whether it replaces or is blended."""
        text = """
inputs: {left: Image, camera: Camera}
hub:
  order: [one, two]
  spokes:
    one: {uses: toy.disparity_cue, in: {image: inputs.left}, with: {disparity: 4.0}}
    two: {uses: toy.disparity_cue, in: {image: inputs.left}, with: {disparity: 8.0},
          reconcile: {uses: toy.blend_disparity, with: {alpha: 1.0}}}
outputs: {depth: map.depth, disparity: map.disparity}
"""
        bright = 0.5 + image / 2
        result = stage.run(text, {"left": bright, "camera": camera_for(image)})
        np.testing.assert_allclose(result["depth"], 400 / (8 * bright), rtol=1e-5)
        np.testing.assert_allclose(result["disparity"], 8 * bright, rtol=1e-5)
        assert set(result.evidence) == {"one", "two"}
        assert result.writers["depth"] == Writer("two", 0, 0)


class Sees(Ports):
    depth: Depth[Array, "H W"]


class Says(Ports):
    evidence: DepthEvidence


class Witness(Module[Params, Sees, Says]):
    """Records the mean depth of the map that it sees, and agrees."""

    name = "witness"

    def run(self, inputs, ctx):
        ctx.measure("depth", inputs.depth.mean())
        return Says(evidence=DepthEvidence.of(inputs.depth, 1.0, 1.0))


class TestFields:
    EDGES = """
inputs: {left: Image}
hub:
  start: {boundaries: none}
  order: [before, edges, after]
  spokes:
    before: {uses: toy.cue, in: {image: inputs.left}, reconcile: {uses: none}}
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}, with: {at: 0.5}}
    after: {uses: toy.cue, in: {image: inputs.left}}
outputs: {depth: map.depth, boundaries: map.boundaries, regions: map.regions, sure: map.boundaries_confidence}
"""

    def test_boundaries_are_none_until_committed(self, stage, image):
        """`before` finds no boundaries and speaks everywhere; `after` abstains on them."""
        result = stage.run(self.EDGES, {"left": image})
        assert result["boundaries"].dtype == bool
        assert result["boundaries"].any()
        assert (result.evidence["before"].reliability > 0).all()
        silent = result.evidence["after"].reliability == 0
        np.testing.assert_array_equal(silent, result["boundaries"])
        np.testing.assert_array_equal(result["sure"], 1)
        assert result.writers["boundaries"] == Writer("edges", 0, 0)
        assert result.writers["depth"] == Writer("after", 0, 0)

    def test_regions_follow_from_boundaries(self, stage):
        """A line across the image makes two regions, 0 on the line itself."""
        image = np.zeros((6, 9), np.float32)
        image[:, 4:] = 1
        result = stage.run(self.EDGES, {"left": image})
        assert result["boundaries"].sum() == 6
        assert result["regions"].tolist() == [[1, 1, 1, 1, 0, 2, 2, 2, 2]] * 6
        assert result.writers["regions"] == result.writers["boundaries"]

    def test_a_field_nobody_writes_keeps_its_start(self, stage, image):
        text = self.EDGES.replace("order: [before, edges, after]", "order: [before]").replace(
            "after: {", "# {"
        ).replace("edges: {", "# {").replace("boundaries: none", "depth: 5.0")  # fmt: skip
        result = stage.run(text, {"left": image})
        np.testing.assert_array_equal(result["depth"], 5)
        assert "boundaries" not in result
        assert "regions" not in result
        assert result.writers == {}

    def test_start_from_a_node(self, stage, image):
        """`start: {depth: node.port}` begins with a value from outside the hub; it may be evidence."""
        text = """
inputs: {left: Image}
nodes: {first: {uses: toy.cue, in: {image: inputs.left}}}
hub: {start: {depth: first.evidence}, order: [], spokes: {}}
outputs: {depth: map.depth}
"""
        np.testing.assert_allclose(stage.run(text, {"left": image})["depth"], 2 - image, rtol=1e-6)

    def test_derived_fields_are_computed_once_a_snapshot_and_only_when_read(self, stage, image, monkeypatch):
        """Three readers of one snapshot's normals cost one computation; nobody reading costs none."""
        seen = []
        real = geometry.normals_from_depth
        monkeypatch.setattr(geometry, "normals_from_depth", lambda *a: seen.append(1) or real(*a))
        stage.modules(own=[ReadsNormals])
        stage.run(ONE, {"left": image})
        assert seen == []
        text = """
inputs: {left: Image}
hub:
  order: [cue, a, b]
  spokes:
    cue: {uses: toy.cue, in: {image: inputs.left}}
    a: {uses: own.reads_normals, reconcile: {uses: none}}
    b: {uses: own.reads_normals, reconcile: {uses: none}}
outputs: {normals: map.normals, depth: map.depth}
"""
        stage.run(text, {"left": image})
        assert len(seen) == 1

    def test_are_read_only_from_the_start(self, stage, image):
        """Even the plane that the map begins with cannot be written into."""
        stage.modules(own=[Scrawls])
        with pytest.raises(Exception, match=r"VI403 node 'pen', own.scrawls"):
            stage.run(
                """
inputs: {left: Image}
hub: {order: [pen], spokes: {pen: {uses: own.scrawls}}}
outputs: {depth: map.depth}
""",
                {"left": image},
            )


class NormalsPorts(Ports):
    normals: Normals[Array, "H W 3"]


class ReadsNormals(Module[Params, NormalsPorts, Says]):
    """Says nothing about depth, having looked at the normals."""

    name = "reads_normals"

    def run(self, inputs, ctx):
        shape = inputs.normals.shape[:2]
        return Says(evidence=DepthEvidence.of(np.zeros(shape, np.float32), 1.0, 0.0))


class Scrawls(Module[Params, Sees, Says]):
    """Writes into the map."""

    name = "scrawls"

    def run(self, inputs, ctx):
        inputs.depth[0, 0] = 0
        return Says(evidence=DepthEvidence.of(inputs.depth, 1.0, 1.0))


class TestLevels:
    TEXT = """
inputs: {left: Image, camera: Camera}
loops: {levels: {over: pyramid, levels: 3}, sweeps: {inside: levels, times: 2}}
hub:
  uses: toy.even
  loop: sweeps
  order: [cue, disparity]
  spokes:
    cue: {uses: toy.cue, in: {image: inputs.left}, levels: [1, 2]}
    disparity: {uses: toy.disparity_cue, in: {image: inputs.left}, with: {disparity: 8.0}}
outputs: {depth: map.depth, f: map.disparity, sure: map.depth_confidence}
"""

    def test_the_map_goes_up_with_its_camera(self, stage, image, camera_for):
        """Disparity is the level's, depth stays; the last word is that of level 0, turn 1."""
        result = stage.run(self.TEXT, {"left": 0.5 + image / 2, "camera": camera_for(image)})
        np.testing.assert_allclose(result["f"] * result["depth"], 400, rtol=1e-5)
        assert result.writers["depth"] == Writer("disparity", 0, 1)
        assert result["depth"].shape == image.shape
        assert stage.calls_of("map") == [(level, turn) for level in (2, 1, 0) for turn in (0, 1)]
        assert stage.calls_of("cue") == [(level, turn) for level in (2, 1) for turn in (0, 1)]

    def test_a_limited_spoke_passes_the_map_through(self, stage, image, camera_for):
        """Where a spoke does not run its commit leaves every field and its writer as they were."""
        text = self.TEXT.replace("order: [cue, disparity]", "order: [disparity, cue]")
        result = stage.run(text, {"left": 0.5 + image / 2, "camera": camera_for(image)})
        assert result.writers["depth"] == Writer("disparity", 0, 1)

    def test_without_a_camera_the_scale_is_the_same_at_every_level(self, stage, image):
        """f = width at full size, half of that at level 1 even of an odd width: depth is one depth."""
        text = self.TEXT.replace("order: [cue, disparity]", "order: [disparity]").replace("    cue:", "    # ")
        text = (
            text.replace("uses: toy.even", "start: {depth: none}")
            .replace("camera: Camera}", "camera: Camera?}")
            .replace("times: 2", "times: 1")
        )
        flat = np.ones((21, 13), np.float32)
        stage.modules(own=[ReadsDepth])
        text = text.replace(
            "hub:", "nodes: {see: {uses: own.reads_depth, loop: sweeps, in: {depth: map.depth}}}\nhub:"
        )
        result = stage.run(text, {"left": flat})
        assert [measure.value for measure in result.measures] == pytest.approx([13 / 8] * 3, rel=1e-6)


class MaybeDepth(Ports):
    depth: Depth[Array, "H W"] | None = None


class Nothing(Ports):
    pass


class ReadsDepth(Module[Params, MaybeDepth, Nothing]):
    """Records the mean depth."""

    name = "reads_depth"

    def run(self, inputs, ctx):
        if inputs.depth is not None:
            ctx.measure("depth", inputs.depth.mean())
        return Nothing()


class TestWarmStart:
    TEXT = TWO.replace("times: 3", "times: 1").replace("order: [near, far]", "order: []")
    TEXT = (
        TEXT[: TEXT.index("  spokes:")]
        + "  spokes: {}\noutputs: {depth: map.depth, sure: map.depth_confidence}\n"
    )

    def test_begins_with_the_given_field(self, stage, image):
        result = stage.run(self.TEXT, {"left": image}, start={"depth": 3 * image})
        np.testing.assert_array_equal(result["depth"], 3 * image)
        np.testing.assert_array_equal(result["sure"], 0)

    def test_with_its_confidence(self, stage, image):
        result = stage.run(self.TEXT, {"left": image}, start={"depth": 3 * image, "depth_confidence": image})
        np.testing.assert_array_equal(result["sure"], image)

    def test_only_the_first_sweep_begins_with_it(self, stage, image):
        """Later sweeps go on from the map, not from the start again."""
        warm = np.full(image.shape, 1.0, np.float32)
        result = stage.run(TWO, {"left": image}, start={"depth": warm})
        z, sure = 1.0, 0.0
        for _ in range(3):
            z, sure = blended(z, sure, 1.0, 0.4)
            z, sure = blended(z, sure, 3.0, 0.3)
        np.testing.assert_allclose(result["depth"], z, rtol=1e-5)

    def test_float64_is_taken_and_the_array_stays_the_callers(self, stage, image):
        warm = (3 * image).astype(np.float64)
        result = stage.run(self.TEXT, {"left": image}, start={"depth": warm})
        assert result["depth"].dtype == np.float32
        assert warm.flags.writeable
        assert not result["depth"].flags.writeable

    def test_nobody_can_write_into_it(self, stage, image):
        stage.modules(own=[Scrawls])
        warm = np.ones_like(image)
        with pytest.raises(Exception, match=r"VI403 node 'pen'"):
            run(
                stage.graph(
                    "inputs: {left: Image}\nhub: {order: [pen], spokes: {pen: {uses: own.scrawls}}}\n"
                    "outputs: {depth: map.depth}"
                ),
                {"left": image},
                options=Options(start={"depth": warm}),
            )
        np.testing.assert_array_equal(warm, 1)

    def test_goes_down_to_the_coarsest_level(self, stage, image, camera_for):
        """In a pyramid the full-size field is brought down by its kind's rule first."""
        flat = np.full(image.shape, 6.0, np.float32)
        text = TestLevels.TEXT.replace("order: [cue, disparity]", "order: []")
        text = text[: text.index("  spokes:")] + "  spokes: {}\noutputs: {depth: map.depth}\n"
        result = stage.run(text, {"left": image, "camera": camera_for(image)}, start={"depth": flat})
        np.testing.assert_allclose(result["depth"], flat, rtol=1e-6)

    @pytest.mark.parametrize(
        ("start", "said"),
        [
            ({"dept": np.ones((21, 13), np.float32)}, r"VI304.*no field 'dept'(.|\n)*depth"),
            ({"depth": np.ones((5, 5), np.float32)}, r"VI307.*5 × 5"),
            ({"depth": np.ones((21, 13), np.uint8)}, r"VI305.*uint8"),
            ({"boundaries": np.ones((21, 13), np.float32)}, r"VI305.*bool"),
        ],
    )
    def test_a_wrong_start_is_an_input_error(self, stage, image, start, said):
        with pytest.raises(InputError, match=said):
            stage.run(self.TEXT, {"left": image}, start=start)

    def test_a_graph_without_a_map_has_no_start(self, stage):
        with pytest.raises(InputError, match=r"VI304.*no map"):
            stage.run(
                "nodes: {one: {uses: toy.constant}}\noutputs: {one: one.value}",
                start={"depth": np.ones((1, 1))},
            )
