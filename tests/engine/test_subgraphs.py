"""Sub-graphs: a call that keeps nothing between calls; it sees the level, turn and size it is made at."""

from __future__ import annotations

import numpy as np
import pytest

from visint.errors import InputError, ModuleError
from visint.events import LoopEnded, Measured
from visint.module import Module, Params, Ports
from visint.results import Stop

DOUBLE = """
visint: 1
name: double
inputs: {x: Scalar}
nodes: {twice: {uses: toy.diverge, in: {value: inputs.x}}}
outputs: {y: twice.value}
"""
POWER = """
visint: 1
name: power
inputs: {x: Scalar}
loops: {turns: {times: 3}}
nodes: {twice: {uses: toy.diverge, loop: turns, feedback: {value: {from: twice.value, start: inputs.x}}}}
outputs: {y: twice.value}
"""
NOISY = """
visint: 1
name: noisy
nodes: {noise: {uses: toy.noise}}
outputs: {y: noise.value}
"""
PLACE = """
visint: 1
name: place
inputs: {left: Image}
nodes: {level: {uses: toy.level}, scale: {uses: own.scale, in: {rows: level.rows}}}
outputs: {rows: level.rows, scale: scale.scale}
"""


class Rows(Ports):
    rows: float


class Scaled(Ports):
    scale: float


class ScaleOf(Module[Params, Rows, Scaled]):
    """What a length in full-size pixels is divided by here."""

    name = "scale"

    def run(self, inputs, ctx):
        ctx.measure("rows", inputs.rows)
        ctx.measure("scale", ctx.scale)
        return Scaled(scale=ctx.scale)


@pytest.fixture
def calls(stage):
    for text in (DOUBLE, POWER, NOISY):
        stage.sub_graph(text)
    return stage


class TestACall:
    def test_gives_what_its_graph_gives(self, calls):
        """The nodes inside are called by the call's name and their own."""
        result = calls.run(
            """
inputs: {x: Scalar}
nodes:
  first: {uses: "graph:double", in: {x: inputs.x}}
  second: {uses: "graph:double", in: {x: first.y}}
outputs: {y: second.y}
""",
            {"x": 3.0},
        )
        assert result["y"] == 12
        assert calls.calls == [
            ("first", 0, 0),
            ("first.twice", 0, 0),
            ("second", 0, 0),
            ("second.twice", 0, 0),
        ]

    def test_starts_anew_each_time(self, calls):
        """2³ at each of two calls: nothing goes round from call to call."""
        result = calls.run(
            """
inputs: {x: Scalar}
nodes:
  first: {uses: "graph:power", in: {x: inputs.x}}
  second: {uses: "graph:power", in: {x: first.y}}
outputs: {first: first.y, second: second.y}
""",
            {"x": 1.0},
        )
        assert (result["first"], result["second"]) == (8, 64)
        assert result.stops == [Stop("first.turns", 0, 3, "times"), Stop("second.turns", 0, 3, "times")]
        assert [event.loop for event in calls.of(LoopEnded)] == ["first.turns", "second.turns"]

    def test_in_a_loop(self, calls):
        """x ← 8x, three times, each turn a call that starts anew."""
        result = calls.run("""
loops: {rounds: {times: 3}}
nodes: {call: {uses: "graph:power", loop: rounds, feedback: {x: {from: call.y, start: 1}}}}
outputs: {y: call.y}
""")
        assert result["y"] == 8**3
        assert calls.calls_of("call") == [(0, 0), (0, 1), (0, 2)]
        assert calls.calls_of("call.twice") == [(0, turn) for _ in range(3) for turn in range(3)]

    def test_within_a_call(self, calls):
        """A sub-graph may call another: names grow, results do not change."""
        calls.sub_graph(
            DOUBLE.replace("name: double", "name: quadruple").replace(
                "twice: {uses: toy.diverge, in: {value: inputs.x}}",
                'a: {uses: "graph:double", in: {x: inputs.x}}, b: {uses: "graph:double", in: {x: a.y}}',
            ).replace("twice.value", "b.y")
        )  # fmt: skip
        text = (
            'inputs: {x: Scalar}\nnodes: {q: {uses: "graph:quadruple", in: {x: inputs.x}}}\noutputs: {y: q.y}'
        )
        assert calls.run(text, {"x": 1.5})["y"] == 6
        assert [name for name, _, _ in calls.calls] == ["q", "q.a", "q.a.twice", "q.b", "q.b.twice"]

    def test_is_lifted_like_any_node(self, calls):
        """A call that a loop feeds nothing is made once, unless something inside goes by chance."""
        calls.run("""
loops: {turns: {times: 3}}
nodes:
  one: {uses: toy.constant}
  still: {uses: "graph:double", loop: turns, in: {x: one.value}}
  noisy: {uses: "graph:noisy", loop: turns}
  sum: {uses: toy.add, loop: turns, in: {a: still.y, b: noisy.y}}
outputs: {sum: sum.sum}
""")
        assert len(calls.calls_of("still")) == 1
        assert len(calls.calls_of("noisy")) == len(calls.calls_of("noisy.noise")) == 3

    def test_optional_inputs_may_be_left_out(self, stage):
        stage.sub_graph("""
visint: 1
name: maybe
inputs: {a: Scalar?, b: Scalar?}
nodes: {add: {uses: toy.add, in: {a: inputs.a, b: inputs.b}}}
outputs: {sum: add.sum}
""")
        result = stage.run("""
nodes:
  one: {uses: toy.constant}
  both: {uses: "graph:maybe", in: {a: one.value, b: one.value}}
  none: {uses: "graph:maybe"}
outputs: {both: both.sum, none: none.sum}
""")
        assert (result["both"], result["none"]) == (2, 0)


class TestWhereItIsMade:
    def test_sees_the_level(self, stage, image):
        """Inside a pyramid the images, the size and the scale are those of the level."""
        stage.modules(own=[ScaleOf])
        stage.sub_graph(PLACE)
        result = stage.run(
            """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}}
nodes: {call: {uses: "graph:place", loop: levels, in: {left: inputs.left}}}
outputs: {rows: call.rows}
""",
            {"left": image},
        )
        assert [m.value for m in result.measures if m.name == "rows"] == [6, 11, 21]
        assert [m.value for m in result.measures if m.name == "scale"] == [4, 2, 1]
        assert [(m.node, m.level) for m in stage.of(Measured)][::2] == [("call.scale", n) for n in (2, 1, 0)]

    def test_a_plane_there_is_the_plane_of_the_level(self, stage, image, camera_for):
        """`start: plane` in a sub-graph at a level: the camera that arrives is the level's already."""
        from visint.arrays import Depth

        class DepthPorts(Ports):
            depth: Depth[Array, "H W"]

        class Keep(Module[Params, DepthPorts, DepthPorts]):
            """Depth as it came."""

            name = "keep"

            def run(self, inputs, ctx):
                ctx.measure("depth", inputs.depth.mean())
                return DepthPorts(depth=inputs.depth)

        stage.modules(own=[Keep])
        stage.sub_graph("""
visint: 1
name: plane
inputs: {left: Image, camera: Camera}
loops: {turns: {times: 1}}
nodes: {keep: {uses: own.keep, loop: turns, feedback: {depth: {from: keep.depth, start: plane}}}}
outputs: {depth: keep.depth}
""")
        result = stage.run(
            """
inputs: {left: Image, camera: Camera}
loops: {levels: {over: pyramid, levels: 3}}
nodes: {call: {uses: "graph:plane", loop: levels, in: {left: inputs.left, camera: inputs.camera}}}
outputs: {depth: call.depth}
""",
            {"left": image, "camera": camera_for(image)},
        )
        assert [measure.value for measure in result.measures] == pytest.approx([100] * 3)

    def test_a_pyramid_of_its_own(self, stage, image):
        """A sub-graph may go through levels itself; they are levels of the images that it is given."""
        stage.sub_graph("""
visint: 1
name: fine
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 2}}
nodes: {see: {uses: toy.image, loop: levels, in: {image: inputs.left}, with: {offset: 1.0}}}
outputs: {image: see.image}
""")
        result = stage.run(
            """
inputs: {left: Image}
nodes: {call: {uses: "graph:fine", in: {left: inputs.left}}}
outputs: {image: call.image}
""",
            {"left": image},
        )
        np.testing.assert_allclose(result["image"], image + 1)
        assert stage.calls == [("call", 0, 0), ("call.see", 1, 0), ("call.see", 0, 0)]

    def test_chance_differs_from_turn_to_turn_and_call_to_call(self, calls):
        """Two calls of one noisy graph differ if they are not the same call; so do the turns of a loop."""
        calls.sub_graph("""
visint: 1
name: noisy_from
inputs: {x: Scalar}
nodes: {noise: {uses: toy.noise, in: {value: inputs.x}}}
outputs: {y: noise.value}
""")
        text = """
inputs: {x: Scalar}
loops: {turns: {times: 4}}
nodes:
  one: {uses: "graph:noisy_from", loop: turns, in: {x: inputs.x}}
  two: {uses: "graph:noisy_from", loop: turns, in: {x: one.y}}
  both: {uses: toy.measure, loop: turns, in: {value: two.y}}
  first: {uses: toy.measure, loop: turns, in: {value: one.y}}
outputs: {both: both.value, first: first.value}
"""
        result = calls.run(text, {"x": 0.0}, seed=3)
        one = [measure.value for measure in result.measures if measure.node == "first"]
        two = [measure.value for measure in result.measures if measure.node == "both"]
        numbers = [*one, *(b - a for a, b in zip(one, two, strict=True))]
        assert len(set(np.round(numbers, 12))) == 8
        again = calls.run(text, {"x": 0.0}, seed=3)
        assert again.measures == result.measures


class TestFailures:
    def test_name_the_node_inside_and_the_call(self, stage):
        stage.sub_graph("""
visint: 1
name: breaks
inputs: {x: Scalar}
nodes: {culprit: {uses: toy.fail, in: {value: inputs.x}}}
outputs: {y: culprit.value}
""")
        with pytest.raises(ModuleError) as caught:
            stage.run(
                'inputs: {x: Scalar}\nnodes: {call: {uses: "graph:breaks", in: {x: inputs.x}}}\n'
                "outputs: {y: call.y}",
                {"x": 1.0},
            )
        (problem,) = caught.value.problems
        assert "node 'call', graph:breaks" in problem.where.path
        assert "node 'culprit', toy.fail (version 1" in problem.where.path
        assert problem.found == "RuntimeError: the toy broke"

    def test_of_what_is_given_name_the_call(self, stage, image, camera_for):
        """Inputs that do not fit each other in a sub-graph are told with the call's name."""
        stage.sub_graph("""
visint: 1
name: sees
inputs: {left: Image, camera: Camera}
nodes: {see: {uses: toy.image, in: {image: inputs.left}}}
outputs: {image: see.image}
""")
        stage.modules(own=[Half])
        with pytest.raises(InputError, match=r"VI307 node 'call', graph:sees.*the camera is of"):
            stage.run(
                """
inputs: {left: Image, camera: Camera}
nodes:
  half: {uses: own.half, in: {image: inputs.left}}
  call: {uses: "graph:sees", in: {left: half.small, camera: inputs.camera}}
outputs: {image: call.image}
""",
                {"left": image, "camera": camera_for(image)},
            )


from visint.arrays import Array, Image  # noqa: E402


class Full(Ports):
    image: Image[Array, "H W"]


class Small(Ports):
    small: Image[Array, "h w"]


class Half(Module[Params, Full, Small]):
    """Every other pixel."""

    name = "half"

    def run(self, inputs, ctx):
        return Small(small=inputs.image[::2, ::2])
