"""Where there is no void: the matcher that explains the second view best, region planes where they are sure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from visint.arrays import Array
from visint.fields import DisparityEvidence

__all__ = ["preferred"]


def preferred(evidence: Sequence[DisparityEvidence]) -> tuple[Array, Array, Array]:
    """Disparity, sigma and reliability, float32 (H, W): the last that speaks; NaN, NaN, 0 where none.

    A graph lists its cues from the coarsest to the one that knows most: a matcher that sees detail after one
    that smooths, planes after the matcher they were fitted to.
    """
    shape = evidence[0].value.shape
    value, sigma = (np.full(shape, np.nan, np.float32) for _ in range(2))
    trust = np.zeros(shape, np.float32)
    for one in evidence:
        speaks = one.reliability > 0
        value, sigma = np.where(speaks, one.value, value), np.where(speaks, one.sigma, sigma)
        trust = np.where(speaks, one.reliability, trust)
    return value, sigma, trust
