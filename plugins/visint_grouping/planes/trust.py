"""How likely a region's plane is right at a pixel: a logistic model of eight signs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from visint.arrays import Array
from visint_grouping.planes.choice import Chosen
from visint_grouping.planes.odds import TrainedOn, chance, log_odds
from visint_grouping.planes.votes import Ballot

__all__ = ["plane_signs", "plane_trust"]

WEIGHTS: Mapping[TrainedOn, tuple[float, ...]] = {
    "all": (-2.079, 1.588, -0.478, -0.214, 0.535, 0.415, -0.085, -0.320),
    "A": (-2.299, 1.668, -0.492, -0.151, 0.602, 0.605, -0.250, -0.411),
    "B": (-2.560, 1.748, -0.356, -0.198, 0.458, 0.418, -0.065, -0.258),
}
BIAS: Mapping[TrainedOn, float] = {"all": 0.473, "A": -0.008, "B": 0.381}
"""Of a plane right to 2 px, fitted by logistic regression on public pairs (all, or one of two halves) and, at a
third of their weight, on rendered scenes with and without noise and on pairs of unrelated images."""
FAR = 8.0


def plane_signs(labels: Array, chosen: Chosen, ballot: Ballot, laid: tuple[Array, Array], own: Array) -> Array:
    """float32 (8, H, W): signs of a right plane.

    The region's energy and its share of near voters; how far the plane lies from a voter, and from what is
    filled; how sure the given map is, apart for voters and holes; whether the right view cannot see the
    surface; its steepness. ``own``: the reliability of the map the planes were fitted to.
    """
    value, sight = laid
    voted = ballot.votes > 0
    off = np.minimum(np.abs(np.nan_to_num(value - ballot.disparity, nan=FAR)), FAR).astype(np.float32)
    sure = log_odds(own)
    steep = np.hypot(chosen.planes[:, 0], chosen.planes[:, 1]).astype(np.float32)
    return np.stack(
        [
            np.minimum(chosen.energy, 1)[labels],
            chosen.share[labels],
            off * voted,
            off * ~voted,
            sure * voted,
            sure * ~voted,
            (sight < 3).astype(np.float32),
            np.nan_to_num(steep)[labels],
        ]
    ).astype(np.float32)


def plane_trust(signs: Array, trained_on: TrainedOn) -> Array:
    """float32 (H, W): the chance that the plane is right to 2 px."""
    return chance(signs, WEIGHTS[trained_on], BIAS[trained_on])
