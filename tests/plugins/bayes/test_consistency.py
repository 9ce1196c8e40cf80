"""Consistency mapping: Eqs. 5.10, 5.48 and 5.80 from their known answers, and the map's own confidence."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from visint.fields import (
    Camera,
    DepthEvidence,
    DisparityEvidence,
    NormalsEvidence,
    ReliefEvidence,
    SlopesEvidence,
    barriers,
)
from visint.fields.geometry import depth_from_disparity, disparity_from_depth, normals_from_depth
from visint.module import Context
from visint.testing import ModuleContract
from visint_bayes.depth import Depth, DepthInputs, DepthParams
from visint_bayes.gradient import Gradient, GradientInputs, GradientParams
from visint_bayes.pointwise import Pointwise, PointwiseInputs
from visint_bayes.sureness import confidence_of, variance_of


class TestDepth(ModuleContract):
    module = Depth


class TestGradient(ModuleContract):
    module = Gradient


class TestPointwise(ModuleContract):
    module = Pointwise


CAMERA = Camera(focal_length=100, cx=5.5, cy=3.5, baseline=1, width=12, height=8)


def field(value=0.0):
    return np.full(CAMERA.size, value, np.float32)


def scene(seed=0, gaps=0.4):
    """Noisy evidence with gaps, a map, and a boundary that cuts the image in two."""
    random = np.random.default_rng(seed)
    disparity = (5 + random.normal(0, 1, CAMERA.size)).astype(np.float32)
    sigma = random.uniform(0.2, 1, CAMERA.size).astype(np.float32)
    trust = np.where(random.random(CAMERA.size) < gaps, 0, random.random(CAMERA.size)).astype(np.float32)
    line = np.zeros(CAMERA.size, bool)
    line[:, 7] = True
    known = (5 + random.normal(0, 0.5, CAMERA.size)).astype(np.float32)
    return DisparityEvidence.of(disparity, sigma, trust), known, line


def inputs(evidence, known, line=None, **more):
    given = {"disparity_evidence": evidence, "depth": depth_from_disparity(known, CAMERA), "camera": CAMERA}
    return DepthInputs(**given, boundaries=line, **more)


def normal_equations(evidence, reached, weight, sharpest=0.1):
    """β and the matrix of Eq. 5.47 written down pair by pair, of pixels that are linked."""
    rows, columns = CAMERA.size
    sigma = np.maximum(np.nan_to_num(evidence.sigma, nan=1), sharpest)
    beta = (evidence.reliability / sigma**2).ravel().astype(float)
    matrix = sp.lil_matrix((beta.size, beta.size))
    matrix.setdiag(beta)
    for y in range(rows):
        for x in range(columns):
            for v, u, bit in ((y, x + 1, 1), (y + 1, x, 2)):
                if reached[y, x] >> bit & 1:
                    i, j = y * columns + x, v * columns + u
                    matrix[i, i] += weight
                    matrix[j, j] += weight
                    matrix[i, j] -= weight
                    matrix[j, i] -= weight
    return beta, matrix.tocsr()


class TestEq510:
    def test_three_observations(self):
        """o = 1, 2, 4 with variances 1, 1, 2: (1 + 2 + 4/2) / (1 + 1 + 1/2) = 2.0, variance 0.4."""
        cues = [DepthEvidence.of(field(o), v**0.5, 1.0) for o, v in ((1, 1), (2, 1), (4, 2))]
        found = Pointwise().run(PointwiseInputs(depth_evidence=cues, depth=field(9), camera=CAMERA), Context())
        assert np.allclose(found.depth, 2.0)
        assert np.allclose(found.sigma**2, 0.4)

    def test_half_sure_counts_half(self):
        """Reliability ½ is twice the variance, 0 nothing; where nobody speaks the map stays, sure as ever."""
        certain = DepthEvidence.of(field(1), 1.0, 1.0)
        half = DepthEvidence.of(field(4), 1.0, np.where(np.arange(12) < 6, 0.5, 0.0).astype(np.float32))
        found = Pointwise().run(PointwiseInputs(depth_evidence=(certain, half), depth=field(9)), Context())
        assert np.allclose(found.depth[:, :6], 2.0)
        assert np.allclose(found.depth[:, 6:], 1.0)
        nobody = PointwiseInputs(depth=field(9), depth_confidence=field(0.3))
        found = Pointwise().run(nobody, Context())
        assert (found.depth == 9).all()
        assert np.allclose(found.depth_confidence, 0.3)
        assert np.isnan(found.sigma).all()

    def test_disparity_counts_as_depth(self):
        """σ_Z = Z² σ_d / fB: two cues that are equally good in depth meet half-way."""
        near = DepthEvidence.of(field(20), 4.0, 1.0)
        told = DisparityEvidence.of(field(5), 1.0, 1.0)
        given = {"depth_evidence": (near,), "disparity_evidence": (told,), "depth": field(9), "camera": CAMERA}
        found = Pointwise().run(PointwiseInputs(**given), Context())
        assert np.allclose(found.depth, 20.0, rtol=1e-5)
        assert np.allclose(found.sigma, 4 / np.sqrt(2), rtol=1e-5)


class TestEq548:
    def test_one_step_is_as_published(self):
        """D = (β D_st + λ D̄)/(β + λ) in the open, β = reliability/σ²."""
        evidence, known, _ = scene(gaps=0.0)
        found = Depth(DepthParams(smoothness=3.0)).run(inputs(evidence, known), Context())
        disparity = disparity_from_depth(found.depth, CAMERA)
        beta = evidence.reliability / evidence.sigma**2
        mean = (known[:-2, 1:-1] + known[2:, 1:-1] + known[1:-1, :-2] + known[1:-1, 2:]) / 4
        inner = (slice(1, -1), slice(1, -1))
        wanted = (beta * evidence.value)[inner] + 3 * mean
        assert np.allclose(disparity[inner], wanted / (beta[inner] + 3), rtol=1e-4)

    @pytest.mark.parametrize("seed", [0, 1, 2])
    def test_solved_equals_the_sparse_direct_solution(self, seed):
        """With gaps in the evidence and a boundary through the image."""
        evidence, known, line = scene(seed)
        params = DepthParams(smoothness=2.0, solve="solved", tolerance=1e-7)
        found = disparity_from_depth(Depth(params).run(inputs(evidence, known, line), Context()).depth, CAMERA)
        reached = barriers.links_within(line, known)
        assert not (reached[:, 6] >> 1 & 1 & reached[:, 7] >> 1 & 1).all()
        beta, matrix = normal_equations(evidence, reached, 0.5)
        wanted = spsolve(matrix.tocsc(), beta * np.nan_to_num(evidence.value).ravel())
        assert np.allclose(found.ravel(), wanted, atol=2e-4)

    def test_steps_go_where_the_solution_is(self):
        """Jacobi steps, each from the map before, end at the solved map."""
        evidence, known, _ = scene(3)
        solved = Depth(DepthParams(solve="solved", tolerance=1e-7)).run(inputs(evidence, known), Context())
        step = Depth(DepthParams())
        for _ in range(400):
            known = disparity_from_depth(step.run(inputs(evidence, known), Context()).depth, CAMERA)
        assert np.allclose(known, disparity_from_depth(solved.depth, CAMERA), atol=1e-3)

    def test_what_nobody_knows_stays(self):
        """Without evidence and without neighbours: here every pixel is a boundary."""
        evidence, known, line = scene(1)
        nothing = DisparityEvidence.of(evidence.value, 1.0, 0.0)
        everywhere = np.ones_like(line)
        found = Depth().run(inputs(nothing, known, everywhere), Context())
        assert np.allclose(disparity_from_depth(found.depth, CAMERA), known, rtol=1e-5)


class TestConfidence:
    def test_confidence_and_variance_are_one_scale(self):
        """½ is one pixel, 0 is nothing, and there and back is where one was."""
        assert np.allclose(variance_of(np.float32([0.5, 1.0, 0.2])), [1, 0, 4])
        assert np.isinf(variance_of(np.float32([0.0])))
        sure = np.linspace(0, 1, 11, dtype=np.float32)
        assert np.allclose(confidence_of(variance_of(sure)), sure, atol=1e-6)

    def test_it_is_that_of_a_kalman_filter(self):
        """Neighbours of variance 1 predict with 1 + 1/λ = 1.25; evidence of 1/β = 0.25 makes 1/(0.8 + 4)."""
        evidence = DisparityEvidence.of(field(5), 0.5, 1.0)
        given = inputs(evidence, field(5), depth_confidence=field(0.5))
        found = Depth(DepthParams(smoothness=4.0)).run(given, Context())
        assert np.allclose(variance_of(found.depth_confidence), 1 / 4.8, rtol=1e-4)
        assert np.allclose(
            variance_of(Depth().run(given, Context(level=1)).depth_confidence), 1 / 1.5, rtol=1e-4
        )

    def test_many_looks_are_not_many_measurements(self):
        """The filter settles where 1/v = 1/(v + 1/λ) + β, however often the same is said."""
        evidence = DisparityEvidence.of(field(5), 0.5, 1.0)
        sure = field(0)
        for _ in range(50):
            given = inputs(evidence, field(5), depth_confidence=sure)
            sure = Depth(DepthParams(smoothness=4.0)).run(given, Context()).depth_confidence
        variance = variance_of(sure)[4, 6]
        assert np.isclose(1 / variance, 1 / (variance + 0.25) + 4, rtol=1e-3)
        assert variance > 0.1

    def test_it_falls_with_the_distance_from_evidence(self):
        """One sure column: each pixel further away the map is less sure, beyond a boundary it knows nothing."""
        trust = np.zeros(CAMERA.size, np.float32)
        trust[:, 2] = 1
        line = np.zeros(CAMERA.size, bool)
        line[:, 8] = True
        sure = field(0)
        for _ in range(60):
            given = inputs(DisparityEvidence.of(field(5), 0.2, trust), field(5), line, depth_confidence=sure)
            sure = Depth().run(given, Context()).depth_confidence
        assert (np.diff(sure[4, 2:8]) < 0).all()
        assert (sure[:, 8:] < 1e-6).all()

    def test_bending_without_stereo_makes_it_less_sure(self):
        """Where a step moved the surface its confidence falls; elsewhere it stays."""
        _, x = np.mgrid[:8, :12].astype(np.float32)
        depth = 20 + 0.3 * (x - 5) ** 2
        relief = ReliefEvidence.of(-depth, 0.1, np.where(x < 6, 1, 0).astype(np.float32))
        given = {"relief_evidence": relief, "depth": depth, "depth_confidence": field(0.8), "camera": CAMERA}
        sure = Gradient().run(GradientInputs(**given), Context()).depth_confidence
        assert (sure[:, 1:5] < 0.8).all()
        assert np.allclose(sure[:, 6:], 0.8)


class TestEq580:
    def bowl(self, sign=1.0):
        y, x = np.mgrid[:8, :12].astype(np.float32)
        return (20 + sign * 0.05 * ((x - 5.5) ** 2 + (y - 3.5) ** 2)).astype(np.float32)

    def run(self, alpha=0.05, **evidence):
        params = GradientParams(alpha=alpha)
        return (
            Gradient(params).run(GradientInputs(depth=self.bowl(), camera=CAMERA, **evidence), Context()).depth
        )

    def test_it_acts_where_the_signs_differ(self):
        """ΔD = 0.05; the cue bends the other way by 1: D̄ − α ΔD_sh = D + 0.05 + 0.05, in the open."""
        found = self.run(relief_evidence=ReliefEvidence.of(self.bowl(-20.0), 0.1, 1.0))
        assert np.allclose((found - self.bowl())[1:-1, 1:-1], 0.1, atol=1e-3)

    def test_it_does_nothing_where_they_agree(self):
        found = self.run(relief_evidence=ReliefEvidence.of(self.bowl(20.0), 0.1, 1.0))
        assert np.array_equal(found, self.bowl())

    def test_the_control_is_the_mean_alone(self):
        """α = 0: the neighbours' mean where the cue bends against the map; its amplitude does not matter."""
        one, other = (
            self.run(0.0, relief_evidence=ReliefEvidence.of(self.bowl(-size), 0.1, 1.0)) for size in (1, 50)
        )
        assert np.array_equal(one, other)
        assert np.allclose((one - self.bowl())[1:-1, 1:-1], 0.05, atol=1e-3)

    def test_it_goes_as_far_as_the_cue_is_sure(self):
        whole = self.run(relief_evidence=ReliefEvidence.of(self.bowl(-20.0), 0.1, 1.0)) - self.bowl()
        part = self.run(relief_evidence=ReliefEvidence.of(self.bowl(-20.0), 0.1, 0.25)) - self.bowl()
        assert np.allclose(part, whole / 4, atol=1e-3)
        silent = self.run(relief_evidence=ReliefEvidence.of(self.bowl(-20.0), 0.1, 0.0))
        assert np.array_equal(silent, self.bowl())

    def test_relief_slopes_and_normals_say_the_same(self):
        """Three forms of one surface: the same correction, but for how the slopes are differenced."""
        dome = self.bowl(-20.0)
        y, x = np.mgrid[:8, :12].astype(np.float32)
        slopes = np.stack([-2 * (x - 5.5), -2 * (y - 3.5)], axis=-1).astype(np.float32)
        by_relief = self.run(relief_evidence=ReliefEvidence.of(dome, 0.1, 1.0))
        by_slopes = self.run(slopes_evidence=SlopesEvidence.of(slopes, 0.1, 1.0))
        assert np.allclose(by_relief[1:-1, 1:-1], by_slopes[1:-1, 1:-1], atol=1e-3)
        shallow = (40 - self.bowl()).astype(np.float32)
        normals = NormalsEvidence.of(normals_from_depth(shallow, CAMERA), 0.1, 1.0)
        by_normals = self.run(normals_evidence=normals)
        by_relief = self.run(relief_evidence=ReliefEvidence.of(shallow, 0.1, 1.0))
        inner = (slice(2, -2), slice(2, -2))
        assert np.allclose(by_normals[inner], by_relief[inner], atol=2e-3)

    def test_no_bend_is_measured_across_a_boundary(self):
        """A step in the map at a boundary is no bend, so a cue that bends there finds nothing to correct."""
        step = np.where(np.arange(12) < 6, 20, 30).astype(np.float32) * np.ones((8, 1), np.float32)
        line = np.zeros(step.shape, bool)
        line[:, 6] = True
        told = {"relief_evidence": ReliefEvidence.of(self.bowl(-20.0), 0.1, 1.0), "depth": step}
        found = Gradient().run(GradientInputs(**told, boundaries=line), Context())
        assert np.array_equal(found.depth, step)
        assert not np.array_equal(Gradient().run(GradientInputs(**told), Context()).depth, step)


def test_a_region_without_evidence_stays_apart():
    """Solved: the other side of a boundary goes flat at its own mean, whatever this side says."""
    evidence, known, line = scene(0)
    trust = np.where(np.arange(12) < 7, evidence.reliability, 0).astype(np.float32)
    given = inputs(DisparityEvidence.of(evidence.value, evidence.sigma, trust), known, line)
    found = Depth(DepthParams(solve="solved", tolerance=1e-6)).run(given, Context())
    right = disparity_from_depth(found.depth, CAMERA)[:, 8:]
    reached = barriers.links(line, line.shape)
    assert np.allclose(right, np.average(known[:, 8:], weights=(reached[:, 8:] > 0)), atol=0.3)
    assert right.std() < 1e-2
