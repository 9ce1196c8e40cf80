"""What a verdict makes of evidence: its value, sigma and reliability."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import barriers
from visint_bayes.coherence.table import ALONE, Verdict

__all__ = ["Side", "spoken"]


class Side(NamedTuple):
    """The cue's own ``sigma`` float32 (H, W), and who is asked."""

    sigma: Array
    boundaries: Array | None
    neighbours: int


def spoken(verdict: Verdict, side: Side) -> tuple[Array, Array, Array]:
    """(value, sigma, reliability) of validated evidence.

    Sigma is the neighbours' mean, reliability the mean of theirs times β. So where they disagree, and the map's
    own value comes back, that is below half of theirs; where the map knows nothing, the evidence abstains.
    """
    reached = barriers.links(side.boundaries, side.sigma.shape)
    around, _ = barriers.mean(side.sigma, reached, side.neighbours)
    alone = verdict.row == ALONE
    sigma = np.where(alone | np.isnan(around), side.sigma, around)
    return verdict.value, sigma, verdict.worth * verdict.beta
