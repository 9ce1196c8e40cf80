"""Levels: sizes, values fitted to them from outside, and what goes round carried from level to level."""

from __future__ import annotations

import numpy as np
import pytest

from visint.arrays import Array, Boundaries, Depth, Disparity, Image, Regions
from visint.errors import InputError
from visint.events import LevelStarted
from visint.fields import KINDS, Camera
from visint.fields.kinds import down, up
from visint.module import Module, Params, Ports
from visint.results import Stop


class Maps(Ports):
    image: Image[Array, "H W"] | None = None
    depth: Depth[Array, "H W"] | None = None
    disparity: Disparity[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    regions: Regions[Array, "H W"] | None = None


class Keep(Module[Params, Maps, Maps]):
    """Every map as it came."""

    name = "keep"

    def run(self, inputs, ctx):
        return Maps(**{name: getattr(inputs, name) for name in Maps.specs})


class Camera3(Ports):
    f: float
    cx: float
    middle: float
    columns: float


class CameraIn(Ports):
    camera: Camera


class Look(Module[Params, CameraIn, Camera3]):
    """What a camera is at a level."""

    name = "look"

    def run(self, inputs, ctx):
        camera = inputs.camera
        for name, value in (("f", camera.focal_length), ("cx", camera.cx), ("columns", camera.width)):
            ctx.measure(name, value)
        ctx.measure("middle", camera.middle_disparity)
        return Camera3(
            f=camera.focal_length, cx=camera.cx, middle=camera.middle_disparity, columns=camera.width
        )


class Shift(Params):
    times: float = 1.0


class Multiply(Module[Shift, Maps, Maps]):
    """Records how large its image is at each level, and gives it times a number."""

    name = "multiply"

    def run(self, inputs, ctx):
        ctx.measure("rows", inputs.image.shape[0])
        ctx.measure("columns", inputs.image.shape[1])
        ctx.measure("scale", ctx.scale)
        return Maps(image=inputs.image * np.float32(self.params.times))


@pytest.fixture
def own(stage):
    stage.modules(own=[Keep, Look, Multiply])
    return stage


def see(loop, node="loop: levels", outputs="image: see.image"):
    return f"""
inputs: {{left: Image}}
loops: {{levels: {{over: pyramid, {loop}}}}}
nodes: {{see: {{uses: own.multiply, {node}, in: {{image: inputs.left}}}}}}
outputs: {{{outputs}}}
"""


def measured(result, name):
    return [measure.value for measure in result.measures if measure.name == name]


class TestSizes:
    @pytest.mark.parametrize(
        ("size", "loop", "sizes"),
        [
            ((21, 13), "levels: 1", [(21, 13)]),
            ((21, 13), "levels: 3", [(6, 4), (11, 7), (21, 13)]),
            ((64, 48), "coarsest: 8", [(11 + 5, 12), (32, 24), (64, 48)]),
            ((64, 48), "coarsest: 6", [(8, 6), (16, 12), (32, 24), (64, 48)]),
            ((5, 5), "coarsest: 8", [(5, 5)]),
            ((5, 1), "levels: 4", [(1, 1), (2, 1), (3, 1), (5, 1)]),
            ((2, 2), "levels: 4", [(1, 1), (1, 1), (1, 1), (2, 2)]),
        ],
    )
    def test_halve_odd_sides_padded(self, own, size, loop, sizes):
        """Each level is half of the one below, odd sides rounded up; `coarsest` bounds the shorter side."""
        result = own.run(see(loop), {"left": np.ones(size, np.float32)})
        assert [event.size for event in own.of(LevelStarted)] == sizes
        seen = list(zip(measured(result, "rows"), measured(result, "columns"), strict=True))
        assert seen == sizes
        assert measured(result, "scale") == [2**level for level in reversed(range(len(sizes)))]
        assert own.calls == [("see", level, 0) for level in reversed(range(len(sizes)))]
        assert result.stops == [Stop("levels", 0, len(sizes), "times")]

    def test_need_an_image(self, own):
        with pytest.raises(InputError, match=r"VI305.*'levels' needs an image"):
            own.run("""
loops: {levels: {over: pyramid, levels: 2}}
nodes: {one: {uses: toy.constant, loop: levels}}
outputs: {one: one.value}
""")


class TestFromOutside:
    def test_an_image_is_averaged(self, own, image):
        """At level 0 it is the image itself; what comes out is that of the last, the finest, level."""
        result = own.run(see("levels: 3"), {"left": image})
        np.testing.assert_array_equal(result["image"], image)

    def test_each_level_sees_the_rule_of_the_kind(self, own, image):
        """A node limited to level 2 sees what two halvings of the kind's rule give."""
        own.modules(own=[Keep, Look, Multiply, Catch])
        Catch.seen = {}
        own.run(
            """
inputs: {left: Image, disparity: Disparity, boundaries: Boundaries, regions: Regions}
loops: {levels: {over: pyramid, levels: 3}}
nodes:
  see: {uses: own.catch, loop: levels, in: {image: inputs.left, disparity: inputs.disparity,
        boundaries: inputs.boundaries, regions: inputs.regions}}
outputs: {image: see.image}
""",
            given := {
                "left": image,
                "disparity": 8 * image,
                "boundaries": image > 0.9,
                "regions": (4 * image).astype(np.int32),
            },
        )
        kinds = {"image": "Image", "disparity": "Disparity", "boundaries": "Boundaries", "regions": "Regions"}
        for port, kind in kinds.items():
            wanted = given["left" if port == "image" else port]
            for level in range(3):
                np.testing.assert_array_equal(Catch.seen[level][port], wanted, err_msg=f"{port} at {level}")
                wanted = down(wanted, KINDS[kind])

    def test_a_camera_scales(self, own, image, camera_for):
        """f, the search range and the size halve; a centre maps by (x + ½)/2 − ½."""
        camera = camera_for(image)
        result = own.run(
            """
inputs: {left: Image, camera: Camera}
loops: {levels: {over: pyramid, levels: 3}}
nodes: {look: {uses: own.look, loop: levels, in: {camera: inputs.camera}}}
outputs: {f: look.f}
""",
            {"left": image, "camera": camera},
        )
        assert measured(result, "f") == [10, 20, 40]
        assert measured(result, "cx") == [(camera.cx + 0.5) / 4 - 0.5, (camera.cx + 0.5) / 2 - 0.5, camera.cx]
        assert measured(result, "middle") == [1, 2, 4]
        assert measured(result, "columns") == [4, 7, 13]

    def test_outside_reads_level_zero(self, own, image):
        """A node after the pyramid sees the finest level's value; one before it runs once."""
        result = own.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}}
nodes:
  before: {uses: toy.image, in: {image: inputs.left}, with: {offset: 1.0}}
  within: {uses: toy.image, loop: levels, in: {image: before.image}}
  after: {uses: toy.stack, in: {images: [within.image, before.image]}}
outputs: {after: after.image}
""",
            {"left": image},
        )
        np.testing.assert_allclose(result["after"], image + 1, rtol=1e-6)
        assert own.calls == [("before", 0, 0)] + [("within", n, 0) for n in (2, 1, 0)] + [("after", 0, 0)]

    def test_two_pyramids_one_after_the_other(self, own, image):
        """The second pyramid begins with what the first ended with, brought down again."""
        result = own.run(
            """
inputs: {left: Image}
loops: {first: {over: pyramid, levels: 2}, second: {over: pyramid, levels: 3}}
nodes:
  one: {uses: toy.image, loop: first, in: {image: inputs.left}, with: {gain: 2.0}}
  two: {uses: toy.image, loop: second, in: {image: one.image}, with: {gain: 2.0}}
outputs: {two: two.image}
""",
            {"left": image},
        )
        np.testing.assert_allclose(result["two"], 4 * image, rtol=1e-6)
        assert own.calls == [("one", 1, 0), ("one", 0, 0), ("two", 2, 0), ("two", 1, 0), ("two", 0, 0)]

    def test_between_two_loops_of_one_pyramid(self, own, image):
        """A value of another loop of the same pyramid is of this level already: it is not fitted again."""
        result = own.run(
            """
inputs: {left: Image}
loops:
  levels: {over: pyramid, levels: 3}
  first: {inside: levels, times: 2}
  second: {inside: levels, times: 2}
nodes:
  one: {uses: toy.smooth, loop: first, in: {source: inputs.left},
        feedback: {image: {from: one.image, start: inputs.left}}}
  two: {uses: own.multiply, loop: second, in: {image: one.image}}
  turn: {uses: toy.turn, loop: second}
outputs: {two: two.image, turn: turn.value}
""",
            {"left": image},
        )
        assert measured(result, "rows") == [6, 11, 21]
        assert own.calls_of("one") == [(level, turn) for level in (2, 1, 0) for turn in (0, 1)]
        assert own.calls_of("two") == [(level, 0) for level in (2, 1, 0)]


class Catch(Module[Params, Maps, Maps]):
    """Keeps what it saw, by level, for the test to look at."""

    name = "catch"
    seen: dict = {}  # noqa: RUF012

    def run(self, inputs, ctx):
        Catch.seen[ctx.level] = {name: getattr(inputs, name) for name in Maps.specs}
        return Maps(image=inputs.image)


ROUND = """
inputs: {{left: Image, start: {kind}}}
loops: {{levels: {{over: pyramid, levels: {levels}{between}}}}}
nodes: {{keep: {{uses: own.keep, loop: levels,
                feedback: {{{port}: {{from: keep.{port}, start: inputs.start}}}}}}}}
outputs: {{end: keep.{port}}}
"""


def round_trip(own, kind, value, levels=3, between=""):
    text = ROUND.format(kind=kind, port=kind.lower(), levels=levels, between=between)
    left = np.zeros(value.shape[:2], np.float32)
    return own.run(text, {"left": left, "start": value})["end"]


class TestCarriedUp:
    @pytest.mark.parametrize("how", [None, "replicate", "linear", "quadratic"])
    @pytest.mark.parametrize("kind", ["Image", "Depth", "Disparity"])
    def test_by_the_rule_of_the_kind_or_between(self, own, image, kind, how):
        """Down twice to start, then up twice by the kind's own rule or the one `between` names for it."""
        between = f", between: {{{kind}: {how}}}" if how else ""
        wanted = image
        for _ in range(2):
            wanted = down(wanted, KINDS[kind])
        for size in ((11, 7), (21, 13)):
            wanted = up(wanted, KINDS[kind], size, how)
        np.testing.assert_array_equal(round_trip(own, kind, image, between=between), wanted)

    def test_between_is_a_choice_a_kind(self, own, image):
        """`between` for disparity does not touch depth."""
        other = round_trip(own, "Depth", image, between=", between: {Disparity: replicate}")
        np.testing.assert_array_equal(other, round_trip(own, "Depth", image))

    def test_disparity_doubles(self, own):
        """8 px at full size are 2 px two levels up, and 8 px again at the end; depth stays as it is."""
        flat = np.full((21, 13), 8, np.float32)
        np.testing.assert_array_equal(round_trip(own, "Disparity", flat), flat)
        np.testing.assert_array_equal(round_trip(own, "Depth", flat), flat)

    def test_a_disparity_of_the_coarsest_level_doubles(self, own, image):
        """A number as start is in pixels of the coarsest level: 1 px there are 4 px at full size."""
        result = own.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}}
nodes: {keep: {uses: own.keep, loop: levels, feedback: {disparity: {from: keep.disparity, start: 1}}}}
outputs: {end: keep.disparity}
""",
            {"left": image},
        )
        np.testing.assert_array_equal(result["end"], np.full(image.shape, 4, np.float32))

    def test_a_thin_boundary_survives_seven_levels(self, own):
        """A one-pixel line is still there, where it was, after six halvings and six doublings."""
        line = np.zeros((128, 100), bool)
        line[:, 37] = True
        end = round_trip(own, "Boundaries", line, levels=7)
        assert end.dtype == bool
        assert end[line].all()
        assert end.mean() < 1

    def test_a_small_region_survives_seven_levels(self, own):
        """A region of 3 × 3 pixels keeps its label, at its place, through seven levels."""
        regions = np.ones((128, 128), np.int32)
        regions[70:73, 50:53] = 2
        end = round_trip(own, "Regions", regions, levels=7)
        assert set(np.unique(end)) == {1, 2}
        assert (end[regions == 2] == 2).any()

    def test_none_stays_none(self, own, image):
        result = own.run(
            ROUND.format(kind="Boundaries?", port="boundaries", levels=3, between=""), {"left": image}
        )
        assert "end" not in result

    def test_down_again_at_the_next_turn_around(self, own, image):
        """A pyramid inside a turn loop: what goes round comes down to the coarsest level again."""
        text = """
inputs: {left: Image}
loops: {turns: {times: 2}, levels: {inside: turns, over: pyramid, levels: 3}}
nodes:
  keep: {uses: own.keep, loop: levels, feedback: {disparity: {from: keep.disparity, start: 1}}}
  size: {uses: own.multiply, loop: levels, in: {image: inputs.left}}
outputs: {end: keep.disparity, size: size.image}
"""
        result = own.run(text, {"left": image})
        np.testing.assert_array_equal(result["end"], np.full(image.shape, 4, np.float32))
        assert own.calls_of("keep") == [(level, turn) for turn in (0, 1) for level in (2, 1, 0)]
        assert measured(result, "rows") == [6, 11, 21] * 2
        assert [stop for stop in result.stops if stop.loop == "levels"] == [Stop("levels", 0, 3, "times")] * 2

    def test_round_an_outer_loop_into_the_pyramid(self, own, image):
        """What goes round outside the pyramid is fitted to each level, like any value from outside."""
        text = """
inputs: {left: Image}
loops: {turns: {times: 3}, levels: {inside: turns, over: pyramid, levels: 2}}
nodes:
  outer: {uses: toy.image, loop: turns, with: {gain: 2.0},
          feedback: {image: {from: outer.image, start: inputs.left}}}
  inner: {uses: own.multiply, loop: levels, feedback: {image: {from: outer.image, start: inputs.left}}}
outputs: {inner: inner.image, outer: outer.image}
"""
        result = own.run(text, {"left": image})
        np.testing.assert_allclose(result["outer"], 8 * image, rtol=1e-6)
        np.testing.assert_allclose(result["inner"], 4 * image, rtol=1e-6)
        assert measured(result, "rows") == [11, 21] * 3


class TestOneLevelOnly:
    def test_at_overrides_parameters(self, own, image):
        """`at: {2: …}` holds at level 2, the rest of the parameters stays; elsewhere `with` holds."""
        text = see("levels: 3").replace(
            "loop: levels,", "loop: levels, with: {times: 3.0}, at: {0: {times: 5.0}},"
        )
        np.testing.assert_allclose(own.run(text, {"left": image})["image"], 5 * image, rtol=1e-6)
        text = text.replace("{0: {times: 5.0}}", "{1: {times: 5.0}}")
        np.testing.assert_allclose(own.run(text, {"left": image})["image"], 3 * image, rtol=1e-6)

    def test_levels_limits_a_node(self, own, image):
        """Where a node does not run its outputs are None: an optional port sees that, a list leaves it out."""
        result = own.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 4}}
nodes:
  some: {uses: toy.counter, loop: levels, levels: [1, 2]}
  seen: {uses: toy.counter, loop: levels, in: {value: some.value}}
  note: {uses: toy.measure, loop: levels, in: {value: seen.value}}
  coarse: {uses: toy.image, loop: levels, levels: [1, 3], in: {image: inputs.left}, with: {offset: 2.0}}
  mean: {uses: toy.stack, loop: levels, in: {images: [inputs.left, coarse.image]}}
outputs: {note: note.value, mean: mean.image}
""",
            {"left": image},
        )
        assert measured(result, "seen") == [1, 2, 2, 1]
        assert own.calls_of("some") == [(2, 0), (1, 0)]
        assert own.calls_of("coarse") == [(3, 0), (1, 0)]
        np.testing.assert_array_equal(result["mean"], image)

    def test_an_output_that_does_not_run_at_full_size_is_absent(self, own, image):
        result = own.run(see("levels: 3", "loop: levels, levels: [2]"), {"left": image})
        assert dict(result) == {}
        assert own.calls == [("see", 2, 0)]

    def test_feedback_of_a_limited_node_waits(self, own, image):
        """A counter that pauses at level 1 goes on at level 0 from where it was."""
        result = own.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}}
nodes: {count: {uses: toy.counter, loop: levels, levels: [0, 2], feedback: {value: {from: count.value}}}}
outputs: {count: count.value}
""",
            {"left": image},
        )
        assert result["count"] == 2

    def test_a_limited_node_has_its_start_where_it_first_runs(self, own, image):
        """Not only at the coarsest level, which it sits out."""
        result = own.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}}
nodes:
  count: {uses: toy.counter, loop: levels, levels: [0, 1], feedback: {value: {from: count.value, start: 5}}}
outputs: {count: count.value}
""",
            {"left": image},
        )
        assert result["count"] == 7

    def test_a_missing_list_is_empty(self, own, image):
        """A list that a limited node would give is an empty list elsewhere, never None."""
        own.modules(own=[Keep, Look, Multiply, Gives, Counts])
        result = own.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 2}}
nodes:
  gives: {uses: own.gives, loop: levels, levels: [1], in: {image: inputs.left}}
  counts: {uses: own.counts, loop: levels, in: {images: gives.images}}
outputs: {count: counts.count}
""",
            {"left": image},
        )
        assert measured(result, "count") == [2, 0]


class Many(Ports):
    images: tuple[Image[Array, "H W"], ...]


class Count(Ports):
    count: float


class OneImage(Ports):
    image: Image[Array, "H W"]


class Gives(Module[Params, OneImage, Many]):
    """The image twice."""

    name = "gives"

    def run(self, inputs, ctx):
        return Many(images=(inputs.image, inputs.image))


class Counts(Module[Params, Many, Count]):
    """How many images there are."""

    name = "counts"

    def run(self, inputs, ctx):
        ctx.measure("count", len(inputs.images))
        return Count(count=len(inputs.images))
