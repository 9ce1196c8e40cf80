"""The truth table of Eqs. 5.31 and 5.52, corrected, for fields of any number of channels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import barriers

__all__ = ["AGREED", "ALONE", "REJECTED", "REPLACED", "Opinions", "Verdict", "validated"]

REJECTED, REPLACED, AGREED, ALONE = 0, 1, 2, 3
"""Neighbours disagree: the map's value stands; they agree, but not with the map: their median; all agree:
the median of all; fewer than two neighbours: nobody can judge, the cue's own value stands."""


class Opinions(NamedTuple):
    """What is validated: float32 (H, W, C), NaN where there is none.

    ``predicted``: what each pixel predicts for its neighbours; ``own``: what the cue says of the pixel itself;
    ``map``: the map's value; ``reliability`` and ``sigma`` (H, W) of the cue.
    """

    predicted: Array
    own: Array
    map: Array
    reliability: Array
    sigma: Array


class Verdict(NamedTuple):
    """The validated ``value`` (H, W, C), and float32 (H, W) each: what it rests on.

    ``reliability`` and ``sigma``: the neighbours' on the average, one who says nothing having no reliability;
    ``beta`` and ``kappa``: confidence 1/(1 + var/ρ) that they agree
    with each other, and with the map (½ is the table's threshold, 1 where nobody can judge); ``row``: uint8,
    which row of the table.
    """

    value: Array
    reliability: Array
    sigma: Array
    beta: Array
    kappa: Array
    row: Array

    @property
    def trust(self) -> Array:
        """The reliability of the validated value: the neighbours' times β.

        Where they disagree, and the map's own value comes back, that is below half of theirs.
        """
        return self.reliability * self.beta

    @property
    def agreement(self) -> float:
        """Share of the pixels with two neighbours or more where these agree; 1 if there is none."""
        judged = int(np.count_nonzero(self.row != ALONE))
        return 1 - int(np.count_nonzero(self.row == REJECTED)) / judged if judged else 1.0


def validated(opinions: Opinions, boundaries: Array | None, neighbours: int, limit: float) -> Verdict:
    """What neighbours on the same side predict, held against each other and the map.

    Parameters
    ----------
    boundaries
        bool (H, W); what lies across one is not asked.
    neighbours
        4 or 8.
    limit
        ρ, a variance: the mean over the channels, in the value's unit squared.
    """
    from visint_bayes.coherence import _kernels

    size = opinions.sigma.shape
    reached = barriers.links_within(boundaries, opinions.own[..., 0])
    value, row = np.empty_like(opinions.own), np.empty(size, dtype=np.uint8)
    told, kept, spread = (np.empty((2, *size), dtype=np.float32) for _ in range(3))
    told[0], told[1] = opinions.reliability, opinions.sigma
    predicted, known = (
        np.ascontiguousarray(np.moveaxis(each, 2, 0)) for each in (opinions.predicted, opinions.map)
    )
    numbers = (reached, neighbours, np.float32(limit))
    _kernels.cohere(predicted, opinions.own, told, known, *numbers, value, kept, spread[0], spread[1], row)
    beta, kappa = (_confidence(each, limit) for each in spread)
    return Verdict(value, kept[0], kept[1], beta, kappa, row)


def _confidence(variance: Array, limit: float) -> Array:
    sure = 1 / (1 + variance / np.float32(limit))
    return np.where(np.isnan(sure), np.float32(1), sure)
