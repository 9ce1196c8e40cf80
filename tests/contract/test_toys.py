"""Every toy module keeps the contract, and does the little it promises."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from visint.errors import Cancelled
from visint.fields import Camera, DepthEvidence, Light
from visint.module import Context
from visint.testing import ModuleContract, sample_inputs, toys
from visint.testing.toys.offenders import FailParams, WrongParams
from visint.testing.toys.witnesses import SleepParams

OFFENDERS = {"fail", "scribble", "wrong"}
INSTANT = {"add", "constant", "counter", "delay", "diverge", "focal", "level", "measure", "noise", "react"}
INSTANT |= {"scale", "threshold", "turn", "warn"}


def contract_of(toy):
    """A test class for one toy."""
    body = {"module": toy, "instant": toy.name in INSTANT}
    return type(f"Test{toy.__name__}", (ModuleContract,), body)


for _toy in toys.TOYS:
    if _toy.name not in OFFENDERS:
        globals()[f"Test{_toy.__name__}"] = contract_of(_toy)


class TestFailThatDoesNot(ModuleContract):
    module = toys.Fail
    instant = True

    def make_params(self):
        return FailParams(at=100.0)


def run(toy, params=None, *, ctx=None, **inputs):
    return toy(params).run(toy.Inputs(**inputs), ctx or Context())


def params(toy, **given):
    return toy.Params(**given)


class TestNames:
    def test_every_toy_has_a_name_of_its_own(self):
        """Names are ids in graph files: no two toys share one, and `TOYS` holds every exported class."""
        assert len({toy.name for toy in toys.TOYS}) == len(toys.TOYS)
        assert {toy.__name__ for toy in toys.TOYS} == set(toys.__all__) - {"TOYS"}


class TestScalars:
    def test_add_counts_what_is_missing_as_zero(self):
        assert run(toys.Add, a=2, b=3).sum == 5
        assert run(toys.Add, b=3).sum == 3
        assert run(toys.Add).sum == 0

    def test_constant(self):
        assert run(toys.Constant, params(toys.Constant, value=-2)).value == -2

    def test_delay_starts_where_it_is_told(self):
        assert run(toys.Delay, params(toys.Delay, start=4)).value == 4
        assert run(toys.Delay, params(toys.Delay, start=4), value=0).value == 0

    def test_threshold_includes_its_bound(self):
        at = params(toys.Threshold, at=2)
        assert [run(toys.Threshold, at, value=v).above for v in (1.9, 2, 2.1)] == [False, True, True]

    def test_diverge_doubles_and_counter_counts(self):
        assert run(toys.Diverge, value=3).value == 6
        assert run(toys.Counter).value == 1
        assert run(toys.Counter, value=6).value == 7

    def test_scale_converges_to_its_fixed_point(self):
        """x ← x/2 + 3 ends at 3/(1 − ½) = 6."""
        p, x = params(toys.Scale, factor=0.5, offset=3), 0.0
        for _ in range(60):
            x = run(toys.Scale, p, value=x).value
        assert x == pytest.approx(6)

    def test_two_reacting_players_reach_nash(self):
        """Best responses (5 − x)/2 by turns end at (5/3, 5/3), the error falling by ¼ a round."""
        x = y = 0.0
        errors = []
        for _ in range(10):
            x = run(toys.React, value=y).value
            y = run(toys.React, value=x).value
            errors.append(abs(x - 5 / 3))
        ratios = np.array(errors[1:]) / errors[:-1]
        assert ratios == pytest.approx(0.25, rel=1e-6)
        assert (x, y) == pytest.approx((5 / 3, 5 / 3), abs=1e-5)


class TestWitnesses:
    def test_turn_and_level_repeat_what_the_context_says(self):
        ctx = Context(level=2, size=(6, 8), turns=(9, 5))
        assert run(toys.Turn, ctx=ctx).value == 5
        seen = run(toys.Level, ctx=ctx)
        assert (seen.level, seen.rows, seen.columns) == (2, 6, 8)
        assert run(toys.Level).rows == 0

    def test_noise_is_the_runs_and_the_turns(self):
        first = [run(toys.Noise, ctx=Context(seed=(1,), turns=(t,))).value for t in range(3)]
        assert len(set(first)) == 3
        assert first == [run(toys.Noise, ctx=Context(seed=(1,), turns=(t,))).value for t in range(3)]

    def test_sleep_ends_when_the_run_is_interrupted(self):
        """A long sleep is left at the first check after the interruption."""
        asked = iter([False, False, True])
        with pytest.raises(Cancelled, match="VI130"):
            run(toys.Sleep, SleepParams(seconds=60), ctx=Context(cancelled=lambda: next(asked)))

    def test_warn_and_measure_speak_up(self):
        notes = []
        ctx = Context(note=lambda *note: notes.append(note))
        assert run(toys.Warn, ctx=ctx, value=2).value == run(toys.Measure, ctx=ctx, value=2).value == 2
        assert notes == [("warning", "toy_warning", "this is only a toy"), ("measure", "seen", 2.0)]


class TestImages:
    def test_smoothing_ends_at_the_direct_solution(self):
        """Jacobi steps of ΔI = 0 with a plane on the border end at the plane, which solves it exactly."""
        plane = np.add.outer(np.arange(7), 2 * np.arange(8)).astype(np.float32)
        image = plane.copy()
        image[1:-1, 1:-1] = 0
        for _ in range(300):
            image = run(toys.Smooth, image=image).image
        assert np.abs(image - plane).max() < 1e-4

    def test_smoothing_with_a_source(self):
        """For I = x² the right-hand side is 2: the parabola stays where it is."""
        parabola = np.tile(np.arange(6, dtype=np.float32) ** 2, (5, 1))
        source = np.full_like(parabola, 2)
        np.testing.assert_array_equal(run(toys.Smooth, image=parabola, source=source).image, parabola)

    def test_stack_is_the_mean(self):
        one = np.ones((2, 3), np.float32)
        np.testing.assert_array_equal(run(toys.Stack, images=(one, 3 * one)).image, 2 * one)

    def test_edges_of_a_step(self):
        image = np.array([[0, 0, 1, 1]], np.float32)
        out = run(toys.Edges, image=image)
        assert out.boundaries.tolist() == [[False, False, True, False]]
        assert out.regions.tolist() == [[1, 1, 0, 2]]

    def test_focal_tells_the_level(self):
        camera = Camera.uncalibrated(64, 48)
        assert run(toys.Focal, camera=camera.halved()).value == 32

    def test_picture(self):
        image = np.array([[0, 0.5]], np.float32)
        out = run(toys.Picture, params(toys.Picture, gain=2, offset=1), image=image)
        assert out.image.tolist() == [[1, 2]]


class TestCues:
    image: ClassVar = np.array([[0, 1], [0.5, 1]], np.float32)

    def test_cue_abstains_on_boundaries(self):
        boundaries = np.array([[True, False], [False, False]])
        out = run(toys.Cue, image=self.image, boundaries=boundaries)
        assert out.evidence.reliability.tolist() == [[0, 1], [1, 1]]
        np.testing.assert_array_equal(out.evidence.value, [[np.nan, 1], [1.5, 1]])

    def test_a_silent_cue_says_nothing(self):
        """Reliability 0 is the amplitude-zero control."""
        out = run(toys.Cue, params(toys.Cue, reliability=0), image=self.image)
        assert np.isnan(out.evidence.value).all()

    def test_disparity_is_in_pixels_of_the_level(self):
        full = run(toys.DisparityCue, image=self.image).evidence
        coarse = run(toys.DisparityCue, ctx=Context(level=2), image=self.image).evidence
        np.testing.assert_allclose(coarse.value * 4, full.value)
        np.testing.assert_allclose(coarse.sigma * 4, full.sigma)

    def test_photometric_grows_surer_with_lights(self):
        lights = (Light.distant(0, 0, -1), Light.at(1, 2, 3))
        out = run(toys.Photometric, images=(self.image,), lights=lights)
        assert out.evidence.reliability == pytest.approx(2 / 3)


class TestHubSteps:
    depth: ClassVar = np.array([[2, np.nan, 2, np.nan]], np.float32)

    def evidence(self, reliability):
        value = np.array([[4, 4, 4, 4]], np.float32)
        return DepthEvidence.of(value, 0.5, np.array([reliability], np.float32))

    def test_cohere_drops_what_is_not_reliable(self):
        out = run(toys.Cohere, evidence=self.evidence([0.2, 0.5, 0.9, 0]))
        assert out.evidence.reliability[0] == pytest.approx([0, 0.5, 0.9, 0])

    def test_blend_moves_by_alpha_and_takes_the_unknown_whole(self):
        out = run(toys.Blend, depth=self.depth, evidence=self.evidence([1, 1, 0.5, 0]))
        np.testing.assert_allclose(out.depth, [[3, 4, 2.5, np.nan]])
        np.testing.assert_allclose(out.depth_confidence, [[0.5, 0.5, 0.25, 0]])

    def test_alpha_zero_leaves_the_map(self):
        still = params(toys.Blend, alpha=0)
        out = run(toys.Blend, still, depth=self.depth[:, :1], evidence=DepthEvidence.of(*_one()))
        assert out.depth.tolist() == [[2]]

    def test_joint_weighs_by_precision(self):
        """Two cues, 1 and 4, the second twice as sharp: (1 + 4·4)/(1 + 4) = 3.4."""
        first = DepthEvidence.of(np.array([[1]], np.float32), 1.0, 1.0)
        second = DepthEvidence.of(np.array([[4]], np.float32), 0.5, 1.0)
        out = run(toys.Joint, depth=np.array([[9]], np.float32), evidence=(first, second))
        assert out.depth == pytest.approx(3.4)
        silent = run(toys.Joint, depth=np.array([[9]], np.float32), evidence=())
        assert silent.depth == 9

    def test_blend_disparity_is_blend_after_conversion(self):
        inputs = sample_inputs(toys.BlendDisparity.Inputs, (5, 6))
        out = toys.BlendDisparity().run(inputs, Context())
        assert out.depth.shape == (5, 6)


def _one():
    return np.array([[4]], np.float32), 0.5, 1.0


class TestOffenders:
    image: ClassVar = np.zeros((3, 4), np.float32)

    def test_scribble_cannot_write(self):
        with pytest.raises(ValueError, match="read-only"):
            run(toys.Scribble, image=self.image)
        assert not self.image.any()

    def test_fail(self):
        with pytest.raises(RuntimeError, match="the toy broke"):
            run(toys.Fail)
        assert run(toys.Fail, FailParams(at=2), value=1.5).value == 1.5
        with pytest.raises(RuntimeError, match="grew"):
            run(toys.Fail, FailParams(at=2, message="grew"), value=2)

    @pytest.mark.parametrize(
        ("what", "found"),
        [
            ("dtype", "wants Image float32 .H, W.; this array is float64"),
            ("axes", "this array has shape .3, 4, 1."),
            ("type", "this is a list, not a numpy array"),
            ("port", "Extra inputs are not permitted"),
            ("size", "H is 3 on port 'image' but 2 on port 'other'"),
        ],
    )
    def test_wrong_outputs_are_refused_as_they_are_built(self, what, found):
        with pytest.raises(ValueError, match=found):
            run(toys.Wrong, WrongParams(what=what), image=self.image)
        run(toys.Wrong, WrongParams(what=what, checked=False), image=self.image)
