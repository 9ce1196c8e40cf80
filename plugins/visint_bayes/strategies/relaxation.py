"""``bayes.relaxation``: each pixel chooses among the cues, and asks its neighbours; Eqs. 2.2 and 2.3."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array
from visint.module import Context, Module, Params
from visint_bayes.strategies.opinions import StrategyInputs, StrategyOutputs, answered, gathered

__all__ = ["Relaxation"]


class RelaxationParams(Params):
    """Parameters of ``bayes.relaxation``.

    Parameters
    ----------
    rounds
        Parallel updates of the weights. More lets neighbourhoods decide, and forgets what was measured.
    agree
        Disparities of neighbours that differ by this, full-size px, are neither compatible nor not; nearer is.
    """

    rounds: int = Field(default=10, ge=0, le=1000)
    agree: float = Field(default=1.0, gt=0)


class Relaxation(Module[RelaxationParams, StrategyInputs, StrategyOutputs]):
    """Probabilistic relaxation: the label of a pixel is the cue that it believes.

    Eq. 2.2, P ← P (1 + ΔP) / Σ P (1 + ΔP), with Eq. 2.3, ΔP_t(y) = Σ_s d Σ_y' r(y, y') P_s(y'). A label has
    the compatibility r = 2^(1 − (Δd/agree)²) − 1 in [−1, 1] with one of a neighbour on the same side; d is one
    over the number of such neighbours, so that 1 + ΔP is never negative. Weights start as the cues' precisions.

    Depth is the mean of the opinions by the weights they end with. Measurements count at the start only: after
    many rounds the constraints decide alone, the method's known weakness.
    """

    name = "relaxation"
    assumptions = ("smoothness", "opacity")

    def run(self, inputs: StrategyInputs, ctx: Context) -> StrategyOutputs:
        """The map after the last round."""
        ctx.check()
        opinions = gathered(inputs)
        agree = self.params.agree / ctx.scale
        weights = relaxed(opinions.values, opinions.shares, opinions.reached, agree, self.params.rounds)
        speaks = opinions.total > 0
        disparity = np.where(speaks, (weights * opinions.values).sum(axis=0), opinions.before)
        believed = weights / np.maximum(weights.max(axis=0, initial=0), np.float32(1e-30))
        precision = (believed * opinions.precision).sum(axis=0)
        return answered(inputs, opinions, disparity, weights, precision, ctx.scale)


def relaxed(values: Array, weights: Array, reached: Array, agree: float, rounds: int) -> Array:
    """Weights (K, H, W) of the labels after ``rounds``, from ``weights`` that sum to 1, or to 0 for silence."""
    from visint_bayes.strategies import _kernels

    before, after = weights.astype(np.float64), np.zeros(weights.shape)
    for _ in range(rounds):
        _kernels.relax(values, before, reached, agree, after)
        before, after = after, before
    return before.astype(np.float32)
