"""``bayes.game``: cues as players who answer each other until nobody wants to move, section 2.8."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array
from visint.module import Context, Module, Params
from visint_bayes.strategies.opinions import Opinions, StrategyInputs, StrategyOutputs, answered, gathered

__all__ = ["Game", "settled"]

Order = Literal["sequential", "parallel"]


class GameParams(Params):
    """Parameters of ``bayes.game``.

    Parameters
    ----------
    heed
        How much a player heeds the others, by their own precision. At 0 each keeps to what it measured.
    rounds
        Of best responses.
    order
        ``sequential``: a player sees the moves of those before it in the round; ``parallel``: nobody does.
    """

    heed: float = Field(default=0.5, ge=0)
    rounds: int = Field(default=20, ge=1, le=1000)
    order: Order = "sequential"


class Game(Module[GameParams, StrategyInputs, StrategyOutputs]):
    """The Nash equilibrium of cues that each want to be near their own measurement and near the others.

    After H. I. Bozma and J. S. Duncan, PAMI 16(11), 1994, doi:10.1109/34.334389. A player's cost is
    F_i = β_i (p_i − e_i)² + heed Σ_j β_j (p_i − p_j)², to be minimised (the text's maximum has no bound). Its
    best response is p_i = (β_i e_i + heed Σ β_j p_j) / (β_i + heed Σ β_j), a contraction. Pixel by pixel; a
    cue that abstains does not play. Depth is the players' mean, weighted by precision.

    The equilibrium is not the minimum of the summed costs, nor Eq. 5.10's mean: each heeds the surer ones, so
    the surest counts for more than its precision.
    """

    name = "game"
    assumptions = ("gaussian_noise", "independence")

    def run(self, inputs: StrategyInputs, ctx: Context) -> StrategyOutputs:
        """The map at the end of the game."""
        ctx.check()
        opinions = gathered(inputs)
        offset, response = self._reactions(opinions)
        moves = settled(offset, response, opinions.values, self.params.rounds, self.params.order)
        speaks, shares = opinions.total > 0, opinions.shares
        if len(moves) > 1:
            ctx.measure("disagreement", _disagreement(moves, shares, speaks))
        disparity = np.where(speaks, (shares * moves).sum(axis=0), opinions.before)
        return answered(inputs, opinions, disparity, shares, opinions.total, ctx.scale)

    def _reactions(self, opinions: Opinions) -> tuple[Array, Array]:
        """(c_i, R_ij) of the best responses p_i = c_i + Σ_j R_ij p_j, float32 (K, H, W) and (K, K, H, W)."""
        precision, heed = opinions.precision, np.float32(self.params.heed)
        others = opinions.total - precision
        whole = np.maximum(precision + heed * others, np.float32(1e-30))
        response = heed * precision[None] / whole[:, None]
        for player in range(len(precision)):
            response[player, player] = 0
        return precision * opinions.values / whole, response


def settled(offset: Array, response: Array, start: Array, rounds: int, order: Order = "sequential") -> Array:
    """Moves after ``rounds`` of best responses to each other.

    Parameters
    ----------
    offset, response
        (K, …) and (K, K, …): p_i = offset_i + Σ_j response_ij p_j; a player does not answer itself.
    start
        First moves, (K, …).
    """
    moves = start.copy()
    for _ in range(rounds):
        seen = moves if order == "sequential" else moves.copy()
        for player in range(len(moves)):
            moves[player] = offset[player] + (response[player] * seen).sum(axis=0)
    return np.asarray(moves)


def _disagreement(moves: Array, shares: Array, speaks: Array) -> float:
    """Weighted rms of how far the players still stand apart, px."""
    mean = (shares * moves).sum(axis=0)
    apart = (shares * (moves - mean) ** 2).sum(axis=0)
    return float(np.sqrt(apart[speaks].mean())) if speaks.any() else 0.0
