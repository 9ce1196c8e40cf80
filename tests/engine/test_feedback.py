"""Feedback edges: a delay of one turn, what it starts with, what carries on and what starts anew."""

from __future__ import annotations

import numpy as np
import pytest

from visint.errors import GraphError, InputError


def test_fibonacci_by_two_feedback_edges(stage):
    """a' = a + b and b' = a from 1 and 0: ten turns after F(2) = 1 is F(11) = 89; calls alternate in order."""
    result = stage.run("""
loops: {turns: {times: 10}}
nodes:
  last: {uses: toy.delay, loop: turns, feedback: {value: {from: sum.sum, start: 1}}}
  before: {uses: toy.delay, loop: turns, feedback: {value: {from: last.value, start: 0}}}
  sum: {uses: toy.add, loop: turns, in: {a: last.value, b: before.value}}
outputs: {fibonacci: sum.sum}
""")
    assert result["fibonacci"] == 89
    assert [call for call in stage.calls if call[0] == "sum"] == [("sum", 0, turn) for turn in range(10)]
    assert len(stage.calls) == 30


@pytest.mark.parametrize(("times", "wanted"), [(1, 1), (2, 1), (3, 2), (4, 3), (5, 5), (12, 144)])
def test_a_node_fed_by_itself_twice(stage, times, wanted):
    """F(n) from a node with two feedback edges, one of them through a delay, for every number of turns."""
    result = stage.run(f"""
loops: {{turns: {{times: {times}}}}}
nodes:
  sum: {{uses: toy.add, loop: turns,
         feedback: {{a: {{from: sum.sum, start: 1}}, b: {{from: old.value, start: 0}}}}}}
  old: {{uses: toy.delay, loop: turns, feedback: {{value: {{from: sum.sum, start: 0}}}}}}
outputs: {{fibonacci: sum.sum}}
""")
    # sum(t) = sum(t−1) + old(t−1), old(t) = sum(t−1): 1, 1, 2, 3, 5 …
    assert result["fibonacci"] == wanted


def test_cells_swap_at_once(stage):
    """Two values that feed each other trade places each turn: no edge sees the turn that is going on."""
    text = """
loops: {{turns: {{times: {times}}}}}
nodes:
  x: {{uses: toy.delay, loop: turns, feedback: {{value: {{from: y.value, start: 1}}}}}}
  y: {{uses: toy.delay, loop: turns, feedback: {{value: {{from: x.value, start: 2}}}}}}
outputs: {{x: x.value, y: y.value}}
"""
    for times in (1, 2, 3, 4):
        result = stage.run(text.format(times=times))
        assert (result["x"], result["y"]) == ((1, 2) if times % 2 else (2, 1))


class TestStart:
    def test_none(self, stage):
        """`start: none` gives None to an optional port in the first turn: a counter counts from 1."""
        result = stage.run("""
loops: {turns: {times: 3}}
nodes: {count: {uses: toy.counter, loop: turns, feedback: {value: {from: count.value}}}}
outputs: {count: count.value}
""")
        assert result["count"] == 3

    def test_number_into_a_scalar(self, stage):
        result = stage.run("""
loops: {turns: {times: 1}}
nodes: {twice: {uses: toy.diverge, loop: turns, feedback: {value: {from: twice.value, start: 2.5}}}}
outputs: {twice: twice.value}
""")
        assert result["twice"] == 5

    def test_number_fills_an_array(self, stage, image):
        """A number for an array port is a flat array of the images' size and of the port's dtype."""
        result = stage.run(
            """
inputs: {left: Image}
loops: {turns: {times: 1}}
nodes:
  see: {uses: toy.stack, in: {images: [inputs.left]}}
  go: {uses: toy.smooth, loop: turns, feedback: {image: {from: go.image, start: 0.25}}}
outputs: {flat: go.image, see: see.image}
""",
            {"left": image},
        )
        assert result["flat"].dtype == np.float32
        np.testing.assert_array_equal(result["flat"], np.full(image.shape, 0.25, np.float32))

    def test_number_needs_a_size(self, stage):
        """Where no input is an image nobody knows how large the flat array should be."""
        with pytest.raises(InputError, match=r"VI305.*no image among its inputs"):
            stage.run("""
loops: {turns: {times: 1}}
nodes: {go: {uses: toy.smooth, loop: turns, feedback: {image: {from: go.image, start: 0}}}}
outputs: {flat: go.image}
""")

    @pytest.mark.parametrize(("times", "wanted"), [(1, 7), (2, 14), (3, 28)])
    def test_reference(self, stage, times, wanted):
        """`start: node.port` from outside the loop; computed once, before the loop begins."""
        result = stage.run(f"""
loops: {{turns: {{times: {times}}}}}
nodes:
  seven: {{uses: toy.constant, with: {{value: 3.5}}}}
  twice: {{uses: toy.diverge, loop: turns, feedback: {{value: {{from: twice.value, start: seven.value}}}}}}
outputs: {{twice: twice.value}}
""")
        assert result["twice"] == wanted
        assert stage.calls[0] == ("seven", 0, 0)
        assert len(stage.calls) == 1 + times

    def test_input_as_a_reference(self, stage):
        result = stage.run(
            """
inputs: {x: Scalar}
loops: {turns: {times: 3}}
nodes: {twice: {uses: toy.diverge, loop: turns, feedback: {value: {from: twice.value, start: inputs.x}}}}
outputs: {twice: twice.value}
""",
            {"x": 1.5},
        )
        assert result["twice"] == 12

    @pytest.mark.parametrize(("span", "depth"), [((2.0, 6.0), 40.0 * 10 / 4), ((0.0, 20.0), 40.0)])
    def test_plane(self, stage, image, camera_for, span, depth):
        """`start: plane` is fronto-parallel at the middle of the search range: Z = fB/d = 40·10/4 = 100."""
        stage.modules(own=[DepthLoop])
        result = stage.run(PLANE, {"left": image, "camera": camera_for(image, disparity_range=span)})
        np.testing.assert_array_equal(result["depth"], np.full(image.shape, depth, np.float32))

    def test_plane_at_each_level(self, stage, image, camera_for):
        """In a pyramid the plane is the same depth at the coarsest level: f and d halve together."""
        stage.modules(own=[DepthLoop])
        text = PLANE.replace("turns: {times: 1}", "turns: {over: pyramid, levels: 3}")
        result = stage.run(text, {"left": image, "camera": camera_for(image)})
        np.testing.assert_allclose(result["depth"], 100.0, rtol=1e-6)
        assert stage.calls_of("keep") == [(2, 0), (1, 0), (0, 0)]

    def test_plane_without_a_camera(self, stage, image):
        """Without a camera the plane is relative, the same at every level and size: f = width, d = width/10."""
        stage.modules(own=[DepthLoop])
        text = PLANE.replace("camera: Camera", "camera: Camera?")
        np.testing.assert_allclose(stage.run(text, {"left": image})["depth"], 10.0, rtol=1e-6)
        text = text.replace("turns: {times: 1}", "turns: {over: pyramid, levels: 4}")
        np.testing.assert_allclose(stage.run(text, {"left": image})["depth"], 10.0, rtol=1e-6)

    def test_reference_inside_the_loop_is_refused(self, stage):
        with pytest.raises(GraphError, match="VI215"):
            stage.graph("""
loops: {turns: {times: 2}}
nodes:
  one: {uses: toy.counter, loop: turns, feedback: {value: {from: one.value}}}
  two: {uses: toy.diverge, loop: turns, feedback: {value: {from: two.value, start: one.value}}}
outputs: {two: two.value}
""")


from visint.arrays import Array, Depth  # noqa: E402
from visint.module import Module, Params, Ports  # noqa: E402


class DepthPorts(Ports):
    depth: Depth[Array, "H W"]


class DepthLoop(Module[Params, DepthPorts, DepthPorts]):
    """Depth as it came."""

    name = "keep"

    def run(self, inputs, ctx):
        return DepthPorts(depth=inputs.depth)


PLANE = """
inputs: {left: Image, camera: Camera}
loops: {turns: {times: 1}}
nodes: {keep: {uses: own.keep, loop: turns, feedback: {depth: {from: keep.depth, start: plane}}}}
outputs: {depth: keep.depth}
"""


class TestDelay:
    def test_is_one_turn_of_the_innermost_loop_around_both(self, stage):
        """From an inner loop of 3 turns to a node of the outer one: it sees the outer turn before (3, 6, 9)."""
        result = stage.run("""
loops: {outer: {times: 4}, inner: {inside: outer, times: 3}}
nodes:
  seen: {uses: toy.delay, loop: outer, with: {start: -1}, feedback: {value: {from: count.value}}}
  note: {uses: toy.measure, loop: outer, in: {value: seen.value}}
  count: {uses: toy.counter, loop: inner, feedback: {value: {from: count.value}}}
outputs: {seen: note.value, count: count.value}
""")
        assert [measure.value for measure in result.measures] == [-1, 3, 6, 9]
        assert result["count"] == 12
        assert stage.calls_of("count") == [(0, turn) for _ in range(4) for turn in range(3)]

    def test_into_an_inner_loop_stays_put_there(self, stage):
        """From the outer loop into the inner one: all inner turns see the same, the outer turn before."""
        result = stage.run("""
loops: {outer: {times: 3}, inner: {inside: outer, times: 2}}
nodes:
  count: {uses: toy.counter, loop: outer, feedback: {value: {from: count.value}}}
  add: {uses: toy.add, loop: inner,
        feedback: {a: {from: count.value, start: 100}, b: {from: add.sum, start: 0}}}
outputs: {sum: add.sum}
""")
        assert result["sum"] == 2 * (100 + 1 + 2)


class TestCarryingOn:
    NESTED = """
loops: {{outer: {{times: 3}}, inner: {{inside: outer, times: 4}}}}
nodes:
  count: {{uses: toy.counter, loop: inner, feedback: {{value: {{from: count.value{restart}}}}}}}
outputs: {{count: count.value}}
"""

    def test_over_outer_turns(self, stage):
        """An accumulator over 3 × 4 turns gives 12: what goes round carries on."""
        assert stage.run(self.NESTED.format(restart=""))["count"] == 12
        assert stage.calls == [("count", 0, turn) for _ in range(3) for turn in range(4)]

    def test_restart(self, stage):
        """With `restart: outer` it gives 4: each outer turn starts anew."""
        assert stage.run(self.NESTED.format(restart=", restart: outer"))["count"] == 4
        assert len(stage.calls) == 12

    def test_restart_takes_the_start_of_that_turn(self, stage):
        """A start inside the loop of the restart is read anew at each of its turns: 1·2³, 2·2³, then 3·2³."""
        result = stage.run("""
loops: {outer: {times: 3}, inner: {inside: outer, times: 3}}
nodes:
  begin: {uses: toy.counter, loop: outer, feedback: {value: {from: begin.value}}}
  twice: {uses: toy.diverge, loop: inner,
          feedback: {value: {from: twice.value, start: begin.value, restart: outer}}}
  note: {uses: toy.measure, loop: outer, in: {value: twice.value}}
outputs: {twice: twice.value, note: note.value}
""")
        assert [measure.value for measure in result.measures] == [8, 16, 24]

    def test_restart_in_the_middle_of_three_loops(self, stage):
        """Restarting at the middle loop of 2 × 3 × 4 leaves 4; at the outermost one 12; nowhere 24."""
        text = """
loops: {{a: {{times: 2}}, b: {{inside: a, times: 3}}, c: {{inside: b, times: 4}}}}
nodes: {{count: {{uses: toy.counter, loop: c, feedback: {{value: {{from: count.value{restart}}}}}}}}}
outputs: {{count: count.value}}
"""
        counts = [stage.run(text.format(restart=r))["count"] for r in (", restart: b", ", restart: a", "")]
        assert counts == [4, 12, 24]
        assert len(stage.calls) == 24

    def test_restart_at_each_level(self, stage, image):
        """`restart` of a pyramid starts anew at each level, at the level's own size."""
        text = """
inputs: {{left: Image}}
loops: {{levels: {{over: pyramid, levels: 3}}, turns: {{inside: levels, times: 2}}}}
nodes:
  count: {{uses: toy.counter, loop: turns, feedback: {{value: {{from: count.value{restart}}}}}}}
  image: {{uses: toy.image, loop: turns, with: {{offset: 1.0}},
           feedback: {{image: {{from: image.image, start: 0{restart}}}}}}}
outputs: {{count: count.value, image: image.image}}
"""
        anew = stage.run(text.format(restart=", restart: levels"), {"left": image})
        assert anew["count"] == 2
        np.testing.assert_array_equal(anew["image"], np.full(image.shape, 2, np.float32))
        on = stage.run(text.format(restart=""), {"left": image})
        assert on["count"] == 6
        np.testing.assert_array_equal(on["image"], np.full(image.shape, 6, np.float32))


def test_what_goes_round_arrives_read_only(stage, image):
    """A start is an input like any other: writing into it is refused, and named."""
    from visint.errors import ModuleError

    for start in ("0", "inputs.left"):
        with pytest.raises(ModuleError, match=r"VI403.*'pen'.*toy.scribble"):
            stage.run(
                f"""
inputs: {{left: Image}}
loops: {{turns: {{times: 2}}}}
nodes: {{pen: {{uses: toy.scribble, loop: turns, feedback: {{image: {{from: pen.image, start: {start}}}}}}}}}
outputs: {{image: pen.image}}
""",
                {"left": image},
            )
