"""Chapter 2's strategies: each with the answer that is known beforehand, and as a reconciler in a hub."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest

import visint
from visint.fields import DepthEvidence, DisparityEvidence, NormalsEvidence, geometry
from visint.module import Context
from visint.testing import ModuleContract, installed
from visint.testing.samples import sample_camera
from visint_bayes.pointwise import Pointwise
from visint_bayes.strategies.description_length import DescriptionLength
from visint_bayes.strategies.fault_lattice import FaultLattice
from visint_bayes.strategies.game import Game, settled
from visint_bayes.strategies.lattice import Nogood, maximal, preferred
from visint_bayes.strategies.mrf import Mrf
from visint_bayes.strategies.relaxation import Relaxation

STRATEGIES = [DescriptionLength, FaultLattice, Game, Mrf, Relaxation]


class TestDescriptionLengthContract(ModuleContract):
    module = DescriptionLength


class TestFaultLatticeContract(ModuleContract):
    """One cue of each kind: five cues of noise clash in every way that there is."""

    module = FaultLattice
    listed = 1


class TestGameContract(ModuleContract):
    module = Game


class TestMrfContract(ModuleContract):
    module = Mrf


class TestRelaxationContract(ModuleContract):
    module = Relaxation


def said(values, sigma=1.0, reliability=1.0):
    """Evidence on disparity from nested lists."""
    return DisparityEvidence.of(np.atleast_2d(np.asarray(values, np.float32)), sigma, np.asarray(reliability))


def ran(module, *evidence, notes=None, **more):
    """(disparity, outputs) of ``module`` on evidence on disparity, from a map at 5 px."""
    shape = evidence[0].value.shape
    camera = sample_camera(shape)
    depth = geometry.depth_from_disparity(np.full(shape, 5, np.float32), camera)
    inputs = module.Inputs(disparity_evidence=evidence, depth=depth, camera=camera, **more)
    note = None if notes is None else lambda what, name, value: notes.__setitem__(name, value)
    outputs = module.run(inputs, Context(size=shape, note=note))
    return geometry.disparity_from_depth(outputs.depth, camera), outputs


class TestRelaxation:
    """Two pixels, two labels that agree with their like only: P = (.6, .4), (.5, .5)."""

    CUES = (said([[10, 10]], reliability=[[0.6, 0.5]]), said([[90, 90]], reliability=[[0.4, 0.5]]))

    @pytest.mark.parametrize(
        ("rounds", "first"), [(0, (0.6, 0.5)), (1, 0.6), (2, 0.692308), (3, 0.835052), (30, 1.0)]
    )
    def test_weights_round_by_round(self, rounds, first):
        """.6, .692308, .835052, and 1 in the end; depth is the mean by the weights."""
        disparity, outputs = ran(Relaxation(Relaxation.Params(rounds=rounds)), *self.CUES)
        np.testing.assert_allclose(outputs.depth_weights[0], np.broadcast_to(first, (1, 2)), atol=1e-6)
        np.testing.assert_allclose(outputs.depth_weights[1], 1 - np.broadcast_to(first, (1, 2)), atol=1e-6)
        np.testing.assert_allclose(disparity, 90 - 80 * np.broadcast_to(first, (1, 2)), rtol=1e-4)

    def test_an_outlier_is_talked_out_of_it(self):
        """A cue that is surer, but alone with what it says at one pixel, loses there to its neighbours."""
        noisy = np.full((5, 5), 8, np.float32)
        noisy[2, 2] = 12
        disparity, _ = ran(Relaxation(), said(noisy, 1.0), said(np.full((5, 5), 8.2), 1.2))
        assert abs(disparity[2, 2] - 8.2) < 0.1

    def test_a_boundary_parts_those_who_ask_each_other(self):
        """On the other side of a boundary nobody's opinion counts."""
        left, right = np.full((3, 7), 6, np.float32), np.full((3, 7), 9, np.float32)
        trust = np.full((3, 7), 0.6)
        trust[:, 4:] = 0.4
        lines = np.zeros((3, 7), bool)
        lines[:, 3] = True
        cues = said(left, reliability=trust), said(right, reliability=1 - trust)
        disparity, _ = ran(Relaxation(Relaxation.Params(rounds=40)), *cues, boundaries=lines)
        np.testing.assert_allclose(disparity[:, :3], 6, atol=1e-3)
        np.testing.assert_allclose(disparity[:, 4:], 9, atol=1e-3)


class TestMrf:
    """The weak string of λ and α breaks where the data steps by more than a height that is known."""

    LAMBDA, ALPHA = 1.3, 2.0

    def lines(self, signal):
        params = Mrf.Params(smoothness=self.LAMBDA**2, line=self.ALPHA, stages=14, rounds=400)
        return ran(Mrf(params), said(signal))[1].lines

    def test_two_pixels(self):
        """h > √(α (1 + 2λ²)) / λ."""
        height = np.sqrt(self.ALPHA * (1 + 2 * self.LAMBDA**2)) / self.LAMBDA
        assert not self.lines([[4, 4 + 0.98 * height]]).any()
        assert self.lines([[4, 4 + 1.02 * height]]).tolist() == [[True, False]]

    def test_a_long_chain(self):
        """h > √(α √(1 + 4λ²)) / λ, which is 1.8157 here."""
        height = np.sqrt(self.ALPHA * np.sqrt(1 + 4 * self.LAMBDA**2)) / self.LAMBDA
        assert height == pytest.approx(1.8157, abs=1e-4)
        step = np.concatenate([np.zeros(60), np.ones(60)])
        assert not self.lines([4 + 0.97 * height * step]).any()
        found = self.lines([4 + 1.03 * height * step])
        assert np.flatnonzero(found).tolist() == [59]

    def test_without_a_line_it_is_the_linear_system(self):
        """Small steps: the solution of (1 + λ² L) f = d."""
        signal = np.array([4.0, 4.2, 4.1, 4.5])
        laplacian = np.diag([1.0, 2, 2, 1]) - np.diag(np.ones(3), 1) - np.diag(np.ones(3), -1)
        wanted = np.linalg.solve(np.eye(4) + 4 * laplacian, signal)
        disparity, _ = ran(Mrf(Mrf.Params(smoothness=4, line=100, rounds=200)), said(signal))
        np.testing.assert_allclose(disparity[0], wanted, atol=1e-4)

    def test_what_is_known_spreads_up_to_a_line(self):
        """Where no cue speaks the membrane hangs between those that do."""
        values = np.full((7, 7), np.nan, np.float32)
        values[:, 0], values[:, 6] = 6, 6.6
        disparity, outputs = ran(Mrf(Mrf.Params(rounds=200)), said(values, 0.1))
        np.testing.assert_allclose(disparity[3], np.linspace(6, 6.6, 7), atol=0.02)
        assert not outputs.lines.any()


class TestGame:
    """F₁ and F₂ of section 2.8, minimised: reactions (5 − p₂)/2 and (5 − p₁)/2, equilibrium (5/3, 5/3)."""

    OFFSET, RESPONSE = np.array([2.5, 2.5]), np.array([[0, -0.5], [-0.5, 0]])

    @pytest.mark.parametrize(("order", "shrinks"), [("sequential", 1 / 4), ("parallel", 1 / 2)])
    def test_the_error_shrinks_by_a_known_factor(self, order, shrinks):
        """By ¼ a round where players see each other's moves, by ½ where they move at once."""
        start = np.array([0.0, 4.0])
        errors = [
            np.abs(settled(self.OFFSET, self.RESPONSE, start, rounds, order) - 5 / 3).max()
            for rounds in range(2, 9)
        ]
        assert [after / before for before, after in pairwise(errors)] == pytest.approx([shrinks] * 6)

    def test_the_equilibrium_is_not_the_best_for_all(self):
        """Costs 4/3 and 7/3 there; the least sum, 2.338, lies at (2.2727, 1.9351)."""
        p, q = settled(self.OFFSET, self.RESPONSE, np.zeros(2), 60)
        assert costs(p, q) == pytest.approx((4 / 3, 7 / 3))
        assert sum(costs(2.2727, 1.9351)) == pytest.approx(2.338, abs=1e-3)
        assert sum(costs(p, q)) > 3.66

    def test_two_cues(self):
        """Precisions 1 and 3 at 4 and 8 px, heed 1: both move, to the solution of two linear equations."""
        cues = said([[4.0]], 1.0), said([[8.0]], 3**-0.5)
        first, second = np.linalg.solve([[1, -0.75], [-0.25, 1]], [1.0, 6.0])
        disparity, _ = ran(Game(Game.Params(heed=1.0, rounds=60)), *cues)
        assert disparity[0, 0] == pytest.approx((first + 3 * second) / 4, rel=1e-5)
        assert disparity[0, 0] > 7, "which Eq. 5.10 gives: the surer counts for more than its precision"

    def test_a_cue_alone_and_a_cue_that_abstains(self):
        """Who is alone keeps to what it measured; who abstains does not play."""
        cues = said([[4.0, np.nan]]), said([[np.nan, np.nan]])
        disparity, outputs = ran(Game(), *cues)
        np.testing.assert_allclose(disparity, [[4, 5]], rtol=1e-6)
        np.testing.assert_allclose([one[0, 0] for one in outputs.depth_weights], [1, 0])


def costs(p, q):
    """F₁ and F₂ of section 2.8."""
    first = (p - 1) ** 2 + (q - 3) ** 2 + (p - 1) * (q - 3)
    return first, 0.75 * (q - 1) ** 2 + 1.5 * (p - 3) ** 2 + 0.75 * (p - 3) * (q - 1)


def sets(*names):
    return [frozenset(one) for one in names]


class TestFaultLattice:
    """The television of section 2.9: G rigidity, D disparity is depth, F a third, T it is a picture."""

    GD, FD = Nogood(frozenset("GD")), Nogood(frozenset("FD"))

    def test_two_premises(self):
        assert list(maximal(frozenset("GD"), [self.GD])) == sets("D", "G")

    def test_a_third_decides_by_votes(self):
        """F goes with G, not with D: {D} and {F, G}; votes pick the pair, trust in D over G picks D."""
        premises, clashes = frozenset("GDF"), [self.GD, self.FD]
        assert list(maximal(premises, clashes)) == sets("FG", "D")
        assert preferred(premises, clashes, "votes", ()) == frozenset("FG")
        assert preferred(premises, clashes, "priority", ("D", "G")) == frozenset("D")
        assert preferred(frozenset("GD"), [self.GD], "votes", ("G",)) == frozenset("G")

    def test_a_new_premise_excuses_the_clash(self):
        """If the image is a picture of a solid thing, it may be flat and rigid: one set with all."""
        assert list(maximal(frozenset("GDT"), [Nogood(frozenset("GD"), "T")])) == sets("DGT")

    def test_against_trying_all_sets(self):
        """Random clashes among eight premises: the same maximal sets as by brute force."""
        rng = np.random.default_rng(4)
        names = "ABCDEFGH"
        for _ in range(20):
            clashes = [Nogood(frozenset(rng.choice(list(names), 3).tolist())) for _ in range(6)]
            subsets = [frozenset(one) for size in range(9) for one in combinations(names, size)]
            sound = [one for one in subsets if not any(clash.rules_out(one) for clash in clashes)]
            wanted = {one for one in sound if not any(one < other for other in sound)}
            found = list(maximal(frozenset(names), clashes))
            assert set(found) == wanted
            assert len(found) == len(wanted)
            assert [len(one) for one in found] == sorted(map(len, found), reverse=True)

    def test_in_an_image(self):
        """The cue whose premises are outvoted is left out where it contradicts, and counts elsewhere."""
        stereo, motion, outline = said([[6, 6, 6]]), said([[6, 12, 6.5]]), said([[6, 12, np.nan]])
        notes: dict[str, float] = {}
        premises = (("opacity",), ("rigidity",), ("general_viewpoint",))
        module = FaultLattice(FaultLattice.Params(premises=premises))
        disparity, outputs = ran(module, stereo, motion, outline, notes=notes)
        np.testing.assert_allclose(disparity, [[6, 12, 6.25]], rtol=1e-5)
        np.testing.assert_allclose(outputs.depth_weights[0], [[1 / 3, 0, 0.5]], rtol=1e-5)
        assert notes["opacity given up"] == pytest.approx(1 / 3)

    def test_trust_in_a_premise_goes_first_if_asked(self):
        premises = (("opacity",), ("rigidity",), ("general_viewpoint",))
        params = FaultLattice.Params(premises=premises, choose="priority", trusted=("opacity",))
        disparity, _ = ran(FaultLattice(params), said([[6]]), said([[12]]), said([[12]]))
        np.testing.assert_allclose(disparity, [[6]], rtol=1e-6)

    def test_a_shared_premise_falls_for_both(self):
        """Two cues that clash and rest on one premise alone: without it neither is believed, the map stays."""
        premises = (("opacity",), ("opacity",))
        disparity, _ = ran(FaultLattice(FaultLattice.Params(premises=premises)), said([[6]]), said([[12]]))
        np.testing.assert_allclose(disparity, [[5]], rtol=1e-6)

    def test_premises_are_names_that_exist(self):
        with pytest.raises(ValueError, match="did you mean 'rigidity'"):
            FaultLattice.Params(premises=(("rigidty",),))


class TestDescriptionLength:
    """0 0 0 10 10 10 with σ = 1: two runs if a run costs less than 108.2021 bits, else one."""

    SIGNAL = np.array([4.0, 4, 4, 14, 14, 14])

    def described(self, bits):
        notes: dict[str, float] = {}
        module = DescriptionLength(DescriptionLength.Params(language="constant", bits=bits))
        disparity, _ = ran(module, said(self.SIGNAL), notes=notes)
        return disparity[0], notes["bits"]

    def test_two_runs_while_they_pay(self):
        assert 150 / 2 * np.log2(np.e) == pytest.approx(108.2021, abs=1e-4)
        for bits, length in ((50, 100), (108, 216)):
            disparity, found = self.described(bits)
            np.testing.assert_allclose(disparity, self.SIGNAL, rtol=1e-5)
            assert found == pytest.approx(length)

    def test_one_run_where_they_do_not(self):
        disparity, found = self.described(109)
        np.testing.assert_allclose(disparity, 9, rtol=1e-5)
        assert found == pytest.approx(109 + 108.2021, abs=1e-3)

    def test_pruning_loses_nothing(self):
        """The shortest length of random rows is that of trying every breakpoint."""
        rng = np.random.default_rng(2)
        for language in ("constant", "line"):
            signal = 6 + np.cumsum(rng.normal(0, 0.5, 14)) + rng.normal(0, 1, 14)
            notes: dict[str, float] = {}
            module = DescriptionLength(DescriptionLength.Params(language=language, bits=3.0))
            ran(module, said(signal), notes=notes)
            assert notes["bits"] == pytest.approx(shortest(np.float32(signal), 3.0, language), rel=1e-5)

    def test_planes_by_rows_and_columns(self):
        """Two slanted planes beside each other come out whole, the noise gone, the edge between them sharp."""
        y, x = np.mgrid[:32, :40]
        truth = np.where(x < 22, 5 + 0.05 * x + 0.03 * y, 11 - 0.04 * x)
        noise = np.random.default_rng(1).normal(0, 0.3, truth.shape)
        disparity, _ = ran(DescriptionLength(), said(truth + noise, 0.3))
        assert np.sqrt(np.mean((disparity - truth) ** 2)) < 0.1
        assert np.abs(disparity - truth)[:, 20:24].max() < 0.5


def shortest(signal, bits, language):
    """The length of the best description, every breakpoint tried."""
    best = [0.0]
    for last in range(1, len(signal) + 1):
        tried = []
        for first in range(last):
            run = signal[first:last].astype(float)
            at = np.arange(len(run))
            degree = 0 if language == "constant" or len(run) < 2 else 1
            left = run - np.polyval(np.polyfit(at, run, degree), at)
            tried.append(best[first] + bits + (left**2).sum() / 2 * np.log2(np.e))
        best.append(min(tried))
    return best[-1]


class TestEveryStrategy:
    """What all have in common."""

    @pytest.mark.parametrize("strategy", STRATEGIES, ids=lambda one: one.name)
    def test_agreement_is_left_alone(self, strategy):
        """Cues that say the same plane give that plane, and are surer together than one of them."""
        y, x = np.mgrid[:16, :20]
        plane = 6 + 0.02 * x + 0.01 * y
        alone, one = ran(strategy(), said(plane, 0.3))
        both, two = ran(strategy(), said(plane, 0.3), said(plane, 0.3))
        np.testing.assert_allclose(alone, plane, atol=0.06)
        np.testing.assert_allclose(both, plane, atol=0.06)
        assert two.depth_confidence.mean() > one.depth_confidence.mean() > 0.5

    @pytest.mark.parametrize("strategy", STRATEGIES, ids=lambda one: one.name)
    def test_silence_leaves_the_map(self, strategy):
        nothing = said(np.full((6, 7), np.nan))
        disparity, outputs = ran(strategy(), nothing, depth_confidence=np.full((6, 7), 0.25, np.float32))
        np.testing.assert_allclose(disparity, 5, rtol=1e-5)
        np.testing.assert_allclose(outputs.depth_confidence, 0.25)
        assert not np.any(outputs.depth_weights)

    def test_all_kinds_of_evidence(self):
        """Depth, disparity and normals of one plane are one opinion; normals speak by the map's neighbours."""
        shape = (12, 14)
        camera = sample_camera(shape)
        depth = np.broadcast_to(np.linspace(500, 520, 14, dtype=np.float32), shape).copy()
        normals = geometry.normals_from_depth(depth, camera)
        disparity = geometry.disparity_from_depth(depth, camera)
        inputs = Game.Inputs(
            depth_evidence=(DepthEvidence.of(depth, 5.0, 1.0),),
            disparity_evidence=(DisparityEvidence.of(disparity, 0.2, 1.0),),
            normals_evidence=(NormalsEvidence.of(normals, 0.1, 1.0),),
            depth=depth,
            camera=camera,
        )
        outputs = Game().run(inputs, Context(size=shape))
        np.testing.assert_allclose(outputs.depth, depth, rtol=1e-3)
        assert len(outputs.depth_weights) == 3
        inner = outputs.depth_weights[2][1:-1, 1:-1]
        assert (inner > 0).all(), "normals have a say wherever the map has neighbours"

    def test_no_evidence_at_all(self):
        """A strategy without cues, as when every spoke is left out, keeps the map."""
        depth = np.full((4, 5), 500, np.float32)
        for strategy in STRATEGIES:
            outputs = strategy().run(strategy.Inputs(depth=depth), Context(size=depth.shape))
            np.testing.assert_array_equal(outputs.depth, depth)
            assert outputs.depth_weights == ()


HUB = """
visint: 1
name: strategy
inputs: {left: Image, camera: Camera}
loops: {sweeps: {times: 2}}
hub:
  uses: bayes.uniform
  loop: sweeps
  order: [near, far]
  reconcile: {depth: {uses: STRATEGY}}
  spokes:
    near: {uses: toy.cue, with: {near: 500.0, far: 500.0, sigma: 20}, in: {image: inputs.left}, cohere: NONE}
    far: {uses: toy.cue, with: {near: 505.0, far: 505.0, sigma: 10}, in: {image: inputs.left}, cohere: NONE}
outputs: {depth: map.depth}
""".replace("NONE", "{uses: none}")


class TestInAHub:
    @pytest.mark.parametrize("strategy", [*STRATEGIES, Pointwise], ids=lambda one: one.name)
    def test_one_line_chooses_it(self, strategy, tmp_path):
        """``reconcile: {depth: {uses: bayes.mrf}}``: cues meet between what they say, the surer counts more."""
        (tmp_path / "g.yaml").write_text(HUB.replace("STRATEGY", f"bayes.{strategy.name}"))
        image = np.full((16, 20), 0.5, np.float32)
        with installed("toys", plugins={"toy": "visint.testing.plugin"}):
            options = visint.Options(attribution=True)
            result = visint.run(
                str(tmp_path / "g.yaml"), left=image, camera=sample_camera((16, 20)), options=options
            )
        assert (result["depth"] > 502).all()
        assert (result["depth"] <= 505.01).all()
        share = result.attribution["depth"]
        if strategy is not Pointwise:
            assert (share["far"] > 2 * share["near"]).all(), "what a strategy says it weighed is what is told"
