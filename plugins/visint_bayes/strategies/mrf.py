"""``bayes.mrf``: a Markov random field of depth with a process of lines, section 2.4."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries
from visint.module import Context, Module, Params
from visint_bayes.strategies.opinions import Opinions, StrategyInputs, StrategyOutputs, answered, gathered

__all__ = ["Mrf"]


class MrfParams(Params):
    """Parameters of ``bayes.mrf``.

    Parameters
    ----------
    smoothness
        λ², px⁻² of the level: neighbours without a line between them differ by 1/λ px. More smooths more.
    line
        α: what a line costs. A lone step of √α/λ px is worth one; more keeps more of the surface in one piece.
    rounds
        Sweeps over the image at each of the ``stages``; a sweep carries what is known by some pixels.
    stages
        From a convex energy to the true one, the springs getting sharper by half each time.
    """

    smoothness: float = Field(default=4.0, gt=0)
    line: float = Field(default=9.0, gt=0)
    rounds: int = Field(default=20, ge=1, le=1000)
    stages: int = Field(default=8, ge=1, le=30)


class MrfOutputs(StrategyOutputs):
    """As of every strategy, and where lines are: right of a pixel or below it."""

    lines: Boundaries[Array, "H W"]


class Mrf(Module[MrfParams, StrategyInputs, MrfOutputs]):
    """The weak membrane: E = Σ β (f − d)² + λ² Σ (f − f')² (1 − l) + α Σ l, lines l between neighbours.

    S. Geman and D. Geman, PAMI 6(6), 1984, doi:10.1109/TPAMI.1984.4767596. Lines are eliminated, which leaves
    springs
    that break at √α/λ, and the energy is made less convex step by step (graduated non-convexity: A. Blake and
    A. Zisserman, Visual Reconstruction, MIT Press 1987), which is deterministic where annealing is not. d is
    the cues' mean and β their precision together. Slow, and it likes steps better than slants.
    """

    name = "mrf"
    assumptions = ("smoothness", "local_spatial_interaction", "opacity", "gaussian_noise")

    def run(self, inputs: StrategyInputs, ctx: Context) -> MrfOutputs:
        """The map of (nearly) least energy, and its lines."""
        opinions = gathered(inputs)
        field = self._settled(opinions, ctx)
        right, below = self._lines(opinions, field)
        ctx.measure("lines", int(right.sum()) + int(below.sum()))
        total = opinions.total
        known = np.isfinite(opinions.before) | (total > 0)
        disparity = np.where(known, field, np.nan)
        weights = opinions.shares * _data_share(total, self.params.smoothness, opinions.reached)
        given = answered(inputs, opinions, disparity, weights, total, ctx.scale)
        return MrfOutputs(**given.__dict__, lines=right | below)

    def _settled(self, opinions: Opinions, ctx: Context) -> Array:
        """float64 (H, W), px."""
        from visint_bayes.strategies import _kernels

        said, weight = opinions.mean, opinions.total
        field = np.where(weight > 0, said, np.nan_to_num(opinions.before)).astype(np.float64)
        speaks = weight[weight > 0]
        sharpness = float(np.median(speaks)) / 4 if speaks.size else 1.0
        for _ in range(self.params.stages):
            ctx.check()
            spring = (self.params.smoothness, self.params.line, sharpness)
            _kernels.weak_membrane(said, weight, opinions.reached, spring, self.params.rounds, field)
            sharpness *= 2
        return field

    def _lines(self, opinions: Opinions, field: Array) -> tuple[Array, Array]:
        from visint_bayes.strategies import _kernels

        right, below = np.zeros(field.shape, bool), np.zeros(field.shape, bool)
        limit = float(np.sqrt(self.params.line / self.params.smoothness))
        _kernels.broken(field, opinions.reached, limit, right, below)
        return right, below


def _data_share(total: Array, smoothness: float, reached: Array) -> Array:
    """How much of a pixel the cues decide, the rest its neighbours."""
    neighbours = sum((reached >> k) & 1 for k in range(4))
    return np.asarray(total / np.maximum(total + np.float32(smoothness) * neighbours, np.float32(1e-30)))
