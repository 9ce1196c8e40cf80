"""Lifting: a node that a turn loop feeds nothing runs once, before the loop; never out of a pyramid."""

from __future__ import annotations

import numpy as np
import pytest

from visint.module import Module, Params, Ports
from visint.testing.toys.scalars import Value


def test_a_node_that_the_loop_feeds_nothing_runs_once(stage):
    """`one` and what follows from it alone run once, before the first turn; `sum` runs each turn."""
    result = stage.run("""
loops: {turns: {times: 5}}
nodes:
  one: {uses: toy.constant, loop: turns}
  two: {uses: toy.diverge, loop: turns, in: {value: one.value}}
  sum: {uses: toy.add, loop: turns, in: {a: two.value}, feedback: {b: {from: sum.sum, start: 0}}}
outputs: {sum: sum.sum}
""")
    assert result["sum"] == 10
    assert stage.calls == [("one", 0, 0), ("two", 0, 0)] + [("sum", 0, turn) for turn in range(5)]


def test_once_a_level(stage, image):
    """Out of the sweeps, not out of the levels: once a level, as many as there are."""
    stage.run(
        """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}, sweeps: {inside: levels, times: 4}}
nodes:
  still: {uses: toy.image, loop: sweeps, in: {image: inputs.left}}
  moves: {uses: toy.smooth, loop: sweeps, in: {source: still.image},
          feedback: {image: {from: moves.image, start: inputs.left}}}
outputs: {image: moves.image}
""",
        {"left": image},
    )
    assert stage.calls_of("still") == [(2, 0), (1, 0), (0, 0)]
    assert stage.calls_of("moves") == [(level, turn) for level in (2, 1, 0) for turn in range(4)]


def test_as_far_as_it_is_fed(stage):
    """A node of the inner loop that only the outer one feeds runs once an outer turn."""
    stage.run("""
loops: {outer: {times: 2}, inner: {inside: outer, times: 3}}
nodes:
  count: {uses: toy.counter, loop: outer, feedback: {value: {from: count.value}}}
  twice: {uses: toy.diverge, loop: inner, in: {value: count.value}}
  sum: {uses: toy.add, loop: inner, in: {a: twice.value}, feedback: {b: {from: sum.sum, start: 0}}}
outputs: {sum: sum.sum}
""")
    assert stage.calls_of("twice") == [(0, 0), (0, 1)]
    assert stage.calls_of("sum") == [(0, turn) for _ in range(2) for turn in range(3)]


def test_what_uses_turns_or_chance_stays(stage):
    """A module that says `per_turn` runs at every turn, and what follows from it does."""
    result = stage.run("""
loops: {turns: {times: 3}}
nodes:
  turn: {uses: toy.turn, loop: turns}
  note: {uses: toy.measure, loop: turns, in: {value: turn.value}}
  noise: {uses: toy.noise, loop: turns}
outputs: {note: note.value, noise: noise.value}
""")
    assert [measure.value for measure in result.measures] == [0, 1, 2]
    for name in ("turn", "note", "noise"):
        assert stage.calls_of(name) == [(0, 0), (0, 1), (0, 2)]


def test_a_feedback_source_that_nothing_moves_is_lifted_too(stage):
    """`five` goes round but never changes: it runs once, and the delay still takes its turn."""
    result = stage.run("""
loops: {turns: {times: 3}}
nodes:
  five: {uses: toy.constant, loop: turns, with: {value: 5.0}}
  late: {uses: toy.delay, loop: turns, feedback: {value: {from: five.value, start: 1}}}
  note: {uses: toy.measure, loop: turns, in: {value: late.value}}
outputs: {note: note.value}
""")
    assert [measure.value for measure in result.measures] == [1, 5, 5]
    assert stage.calls_of("five") == [(0, 0)]


@pytest.mark.parametrize("value", [float(v) for v in range(2, 12)])
def test_what_is_lifted_runs_before_the_loop_that_reads_it_after_a_turn(stage, value):
    """Wherever the order of the schedule would put it, what goes round or is watched is there by then."""
    result = stage.run(f"""
loops: {{turns: {{times: 3, until: {{holds: never.above}}}}}}
nodes:
  high: {{uses: toy.constant, with: {{value: {value}}}}}
  five: {{uses: toy.delay, loop: turns, with: {{start: {value}}}}}
  never: {{uses: toy.threshold, loop: turns, with: {{at: 20}}, in: {{value: high.value}}}}
  late: {{uses: toy.delay, loop: turns, feedback: {{value: {{from: five.value, start: 1}}}}}}
  note: {{uses: toy.measure, loop: turns, in: {{value: late.value}}}}
outputs: {{note: note.value}}
""")
    assert [measure.value for measure in result.measures] == [1, value, value]
    names = [name for name, _, _ in stage.calls]
    assert max(names.index("five"), names.index("never")) < names.index("late")


def test_a_loop_all_of_whose_nodes_are_lifted_does_not_run(stage):
    result = stage.run("""
loops: {turns: {times: 1000}}
nodes: {one: {uses: toy.constant, loop: turns}}
outputs: {one: one.value}
""")
    assert result["one"] == 1
    assert stage.calls == [("one", 0, 0)]


def test_many_calls_become_few_and_the_arrays_stay_the_same(stage, image):
    """7 levels × 20 turns: 7 calls instead of 140, and the very bits that a per-turn twin gives."""
    stage.modules(own=[Restless])
    text = """
inputs: {{left: Image}}
loops: {{levels: {{over: pyramid, levels: 7}}, turns: {{inside: levels, times: 20}}}}
nodes:
  still: {{uses: {uses}, loop: turns}}
  sum: {{uses: toy.add, loop: turns, in: {{a: still.value}}, feedback: {{b: {{from: sum.sum, start: 0}}}}}}
outputs: {{sum: sum.sum}}
"""
    left = {"left": np.zeros((64, 64), np.float32)}
    lifted = stage.run(text.format(uses="toy.constant"), left)["sum"]
    assert len(stage.calls_of("still")) == 7
    assert stage.run(text.format(uses="own.restless"), left)["sum"] == lifted == 140
    assert len(stage.calls_of("still")) == 140


class Nothing(Ports):
    pass


class Restless(Module[Params, Nothing, Value]):
    """1, at every turn."""

    name = "restless"
    per_turn = True

    def run(self, inputs, ctx):
        return Value(value=1.0)
