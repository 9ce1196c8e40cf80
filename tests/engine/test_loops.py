"""Turn loops: the exact bound, convergence, flags, patience, exhaustion; every stop with its reason."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import lil_matrix
from scipy.sparse.linalg import spsolve

from visint.errors import ModuleError
from visint.events import LoopEnded, TurnFinished
from visint.results import Stop, Turn

HALVING = """
loops: {{turns: {{times: {times}{until}}}}}
nodes: {{half: {{uses: toy.scale, loop: turns, with: {{factor: {factor}}},
               feedback: {{value: {{from: half.value, start: 1}}}}}}}}
outputs: {{half: half.value}}
"""


def halving(times=50, until="", factor=0.5):
    return HALVING.format(times=times, until=f", until: {until}" if until else "", factor=factor)


class TestBound:
    @pytest.mark.parametrize("times", [1, 2, 7, 100])
    def test_is_exact(self, stage, times):
        """`times: n` alone is n turns, no more and no less, and says so."""
        result = stage.run(halving(times))
        assert result["half"] == 0.5**times
        assert stage.calls == [("half", 0, turn) for turn in range(times)]
        assert result.stops == [Stop("turns", 0, times, "times")]
        assert result.trace == []

    def test_nested_loops_stop_each_time_they_run(self, stage):
        result = stage.run("""
loops: {outer: {times: 3}, inner: {inside: outer, times: 4}}
nodes:
  count: {uses: toy.counter, loop: inner, feedback: {value: {from: count.value}}}
outputs: {count: count.value}
""")
        assert sorted(result.stops) == [Stop("inner", 0, 4, "times")] * 3 + [Stop("outer", 0, 3, "times")]


class TestConvergence:
    def test_change_below(self, stage):
        """x ← x/2 + 1 from 0: the change 2⁻ᵗ/(2 − 2⁻ᵗ) falls below 0.01 at turn 6, the seventh."""
        text = halving(until="{change_of: half.value, below: 0.01}").replace("0.5}", "0.5, offset: 1}")
        result = stage.run(text.replace("start: 1", "start: 0"))
        change = [2.0**-t / (2 - 2.0**-t) for t in range(1, 20)]
        turns = next(t for t, one in enumerate(change, 1) if one < 0.01) + 1
        assert turns == 7
        assert result.stops == [Stop("turns", 0, turns, "converged")]
        assert [turn.change for turn in result.trace] == pytest.approx(change[: turns - 1])
        assert [turn.turn for turn in result.trace] == list(range(1, turns))

    def test_the_first_turn_never_counts(self, stage):
        """A value that never changes still goes round twice: one turn alone shows no change."""
        result = stage.run(halving(until="{change_of: half.value, below: 0.5}", factor=1.0))
        assert result.stops == [Stop("turns", 0, 2, "converged")]
        assert result.trace == [Turn("turns", 0, 1, 0.0)]

    @pytest.mark.parametrize("patience", [1, 2, 5])
    def test_patience(self, stage, patience):
        """`patience: n` wants n calm turns in a row, the first turn never among them."""
        until = f"{{change_of: half.value, below: 0.5, patience: {patience}}}"
        assert stage.run(halving(until=until, factor=1.0)).stops[0].turns == 1 + patience

    def test_patience_starts_anew_after_a_lively_turn(self, stage):
        """Calm, lively, calm, calm: two calm turns in a row are wanted, not two in all."""
        stage.modules(own=[Staircase])
        text = """
loops: {turns: {times: 20, until: {change_of: go.value, below: 0.1, patience: 2}}}
nodes: {go: {uses: own.staircase, loop: turns}}
outputs: {go: go.value}
"""
        result = stage.run(text)  # 1 1 2 2 2: calm at turn 1, lively at 2, calm at 3 and 4
        assert result.stops == [Stop("turns", 0, 5, "converged")]

    def test_counts_anew_at_each_level_and_outer_turn(self, stage, image):
        """No change is measured across levels: the first turn of each never counts."""
        result = stage.run(
            """
inputs: {left: Image}
loops:
  levels: {over: pyramid, levels: 3}
  turns: {inside: levels, times: 9, until: {change_of: same.value, below: 0.5}}
nodes: {same: {uses: toy.scale, loop: turns, with: {factor: 1.0},
               feedback: {value: {from: same.value, start: 1}}}}
outputs: {same: same.value}
""",
            {"left": image},
        )
        assert [stop for stop in result.stops if stop.loop == "turns"] == [
            Stop("turns", level, 2, "converged") for level in (2, 1, 0)
        ]
        assert stage.calls == [("same", level, turn) for level in (2, 1, 0) for turn in (0, 1)]

    def test_nothing_to_compare_is_no_convergence(self, stage):
        """NaN throughout: the change is unknown, which is not small."""
        until = "{change_of: half.value, below: 10}"
        result = stage.run(halving(times=4, until=until).replace("start: 1", "start: .nan"))
        assert result.stops == [Stop("turns", 0, 4, "exhausted")]
        assert all(np.isnan(turn.change) for turn in result.trace)

    def test_a_loop_watches_a_loop_inside_it(self, stage):
        """The outer loop's `change_of` may be a value of the inner loop: it sees its last turn."""
        result = stage.run("""
loops:
  outer: {times: 30, until: {change_of: half.value, below: 0.01}}
  inner: {inside: outer, times: 3}
nodes: {half: {uses: toy.scale, loop: inner, with: {factor: 0.5, offset: 1},
               feedback: {value: {from: half.value, start: 0}}}}
outputs: {half: half.value}
""")
        x, seen = 0.0, [None]
        while seen[-1] is None or len(seen) < 3 or abs(seen[-1] - seen[-2]) / seen[-1] >= 0.01:
            for _ in range(3):
                x = x / 2 + 1
            seen.append(x)
        assert result["half"] == x
        assert result.stops[0] == Stop("outer", 0, len(seen) - 1, "converged")


class TestHolds:
    TEXT = """
loops: {{turns: {{times: {times}, until: {{holds: enough.above}}{more}}}}}
nodes:
  count: {{uses: toy.counter, loop: turns, feedback: {{value: {{from: count.value}}}}}}
  enough: {{uses: toy.threshold, loop: turns, with: {{at: {at}}}, in: {{value: count.value}}}}
outputs: {{count: count.value}}
"""

    @pytest.mark.parametrize("at", [1, 5])
    def test_ends_the_turn_in_which_it_holds(self, stage, at):
        """A flag ends the loop after the turn that raised it, the first one included."""
        result = stage.run(self.TEXT.format(times=9, at=at, more=""))
        assert result["count"] == at
        assert result.stops == [Stop("turns", 0, at, "held")]

    def test_at_the_bound_is_held_and_not_exhausted(self, stage):
        result = stage.run(self.TEXT.format(times=4, at=4, more=", on_exhausted: fail"))
        assert result.stops == [Stop("turns", 0, 4, "held")]


class TestExhausted:
    def exhausted(self, how):
        until = f"{{change_of: half.value, below: 1.0e-9}}, on_exhausted: {how}"
        return halving(times=3, until=until, factor=2)

    def test_accept(self, stage):
        """By default the bound is as good an end as any; the reason is on record."""
        result = stage.run(self.exhausted("accept"))
        assert result["half"] == 8
        assert result.stops == [Stop("turns", 0, 3, "exhausted")]
        assert result.warnings == []

    def test_warn(self, stage):
        result = stage.run(self.exhausted("warn"))
        assert result["half"] == 8
        (warned,) = result.warnings
        assert (warned.node, warned.level, warned.turn, warned.code) == ("turns", 0, 2, "exhausted")
        assert "3 times" in warned.text

    def test_fail(self, stage):
        """`on_exhausted: fail` is an error that names the loop and the line to write."""
        with pytest.raises(ModuleError, match=r"VI404.*'turns' went round 3 times") as caught:
            stage.run(self.exhausted("fail"))
        assert caught.value.problems[0].fault == "graph"
        assert "on_exhausted: accept" in str(caught.value)

    def test_a_bound_reached_by_converging_is_no_exhaustion(self, stage):
        """Converging in the very last turn is converging."""
        until = "{change_of: half.value, below: 0.5}, on_exhausted: fail"
        result = stage.run(halving(times=2, until=until, factor=1.0))
        assert result.stops == [Stop("turns", 0, 2, "converged")]


class TestKnownAnswers:
    GAME = """
loops: {{turns: {{times: {times}}}}}
nodes:
  one: {{uses: toy.react, loop: turns, feedback: {{value: {{from: two.value, start: 0}}}}}}
  two: {{uses: toy.react, loop: turns, {second}}}
outputs: {{one: one.value, two: two.value}}
"""
    SEQUENTIAL = "in: {value: one.value}"
    PARALLEL = "feedback: {value: {from: one.value, start: 0}}"

    @pytest.mark.parametrize(("second", "rate"), [(SEQUENTIAL, 1 / 4), (PARALLEL, 1 / 2)])
    def test_two_players_reach_nash(self, stage, second, rate):
        """Reaction curves p = (5 − q)/2 meet at (5/3, 5/3): error × ¼ a turn in sequence, × ½ at once."""
        errors = []
        for times in range(1, 9):
            result = stage.run(self.GAME.format(times=times, second=second))
            errors.append(abs(result["two"] - 5 / 3))
        assert [b / a for a, b in pairwise(errors)] == pytest.approx([rate] * 7, rel=1e-9)
        result = stage.run(self.GAME.format(times=60, second=second))
        assert (result["one"], result["two"]) == pytest.approx((5 / 3, 5 / 3), abs=1e-12)

    def test_jacobi_relaxation_reaches_the_direct_solution(self, stage):
        """ΔI = s with a fixed border: the end is the linear solver's, the turn it stops at a plain loop's."""
        rng = np.random.default_rng(7)
        border = rng.random((9, 12), dtype=np.float32)
        source = (0.1 * rng.standard_normal((9, 12))).astype(np.float32)
        result = stage.run(
            """
inputs: {border: Image, source: Image}
loops: {turns: {times: 2000, until: {change_of: relax.image, below: 1.0e-6, patience: 2}}}
nodes:
  relax: {uses: toy.smooth, loop: turns, in: {source: inputs.source},
          feedback: {image: {from: relax.image, start: inputs.border}}}
outputs: {image: relax.image}
""",
            {"border": border, "source": source},
        )
        np.testing.assert_allclose(result["image"], direct(border, source), atol=1e-4)
        assert result.stops == [Stop("turns", 0, reference_turns(border, source, 1e-6, 2), "converged")]
        changes = [turn.change for turn in result.trace]
        assert changes[-1] < 1e-6
        assert len(changes) == result.stops[0].turns - 1


def direct(border, source):
    """The solution of ΔI = s (five points) with the border held, by a sparse solver."""
    rows, columns = border.shape
    count = rows * columns
    matrix, right = lil_matrix((count, count)), np.empty(count)
    for i in range(rows):
        for j in range(columns):
            k = i * columns + j
            if i in (0, rows - 1) or j in (0, columns - 1):
                matrix[k, k], right[k] = 1, border[i, j]
            else:
                matrix[k, k], right[k] = -4, source[i, j]
                for other in (k - 1, k + 1, k - columns, k + columns):
                    matrix[k, other] = 1
    return spsolve(matrix.tocsr(), right).reshape(border.shape)


def reference_turns(border, source, below, patience):
    """Turns until the relative rms change was below the bound often enough in a row."""
    old, calm, turns = border, 0, 0
    before = None
    while calm < patience:
        new = old.copy()
        new[1:-1, 1:-1] = (old[:-2, 1:-1] + old[2:, 1:-1] + old[1:-1, :-2] + old[1:-1, 2:]) / 4
        new[1:-1, 1:-1] -= source[1:-1, 1:-1] / 4
        turns += 1
        if before is not None:
            change = np.linalg.norm((new - before).astype(float)) / np.linalg.norm(new.astype(float))
            calm = calm + 1 if change < below else 0
        before = old = new
    return turns


def test_every_turn_and_every_stop_is_told(stage):
    """An observer hears of each turn with its change, and of the end with its reason."""
    until = "{change_of: half.value, below: 0.7, patience: 1}"
    stage.run(halving(until=until, factor=0.6))
    turns = stage.of(TurnFinished)
    assert [(turn.loop, turn.level, turn.turn) for turn in turns] == [("turns", 0, 0), ("turns", 0, 1)]
    assert turns[0].change is None
    assert turns[1].change == pytest.approx(0.4 / 0.6)
    assert stage.of(LoopEnded) == [LoopEnded("turns", 0, 2, "converged")]


from visint.module import Module, Params, Ports  # noqa: E402
from visint.testing.toys.scalars import Value  # noqa: E402


class Nothing(Ports):
    pass


class Staircase(Module[Params, Nothing, Value]):
    """1, 1, 2, 2, 2, …"""

    name = "staircase"
    per_turn = True

    def run(self, inputs, ctx):
        return Value(value=1.0 if ctx.turn < 2 else 2.0)
