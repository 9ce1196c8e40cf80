"""Confidence: whether what a map trusts is what is right."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from visint.arrays import Array, Confidence, Depth, Mask
from visint.module import Context, Module, Params, Ports
from visint_lab.metrics.counted import counted

__all__ = ["ConfidenceScore", "Sparsification", "confidence_scores", "sparsification"]

STEPS = 100


class Sparsification(NamedTuple):
    """Mean error of the most trusted pixels, by how many are kept.

    ``density`` falls from 1; ``curve`` is the mean error of the most confident share, ``oracle`` the same with
    pixels ordered by their true error: no confidence can do better.
    """

    density: Array
    curve: Array
    oracle: Array

    @property
    def area(self) -> float:
        """Mean gap between curve and oracle over all densities, as a part of the error of all pixels (AUSE).

        0 is a perfect order; a random one has about the oracle's own gain.
        """
        whole = self.curve[0]
        return float((self.curve - self.oracle).mean() / whole) if whole > 0 else 0.0


def sparsification(error: Array, confidence: Array) -> Sparsification:
    """The curves for errors (N,) ≥ 0 and confidences (N,); pixels of equal confidence share their mean error.

    Reference: Ilg et al. 2018, "Uncertainty estimates and multi-hypotheses networks for optical flow",
    doi:10.1007/978-3-030-01234-2_40.
    """
    kept = np.arange(STEPS, 0, -1) / STEPS
    counts = np.maximum(np.ceil(kept * error.size).astype(int), 1)
    levels, place = np.unique(-confidence, return_inverse=True)
    sums = np.bincount(place, weights=error, minlength=len(levels))
    sizes = np.bincount(place, minlength=len(levels))
    tied = np.repeat(sums / sizes, sizes)
    best = np.sort(error)
    curves = [np.cumsum(order, dtype=np.float64)[counts - 1] / counts for order in (tied, best)]
    return Sparsification(kept, *curves)


def confidence_scores(error: Array, confidence: Array, mask: Array | None = None) -> Mapping[str, float]:
    """``ause`` and ``risk90`` (the mean error of the 90 % most confident pixels, ``error``'s unit).

    ``error`` (H, W) is NaN where nothing is known; unknown confidence counts as 0.
    """
    where = counted(error, mask)
    if not where.any():
        return {"ause": float("nan"), "risk90": float("nan")}
    curves = sparsification(error[where].astype(np.float64), np.nan_to_num(confidence)[where])
    return {"ause": curves.area, "risk90": float(curves.curve[STEPS // 10])}


class ConfidenceScoreInputs(Ports):
    """A depth map with its confidence, and the truth; ``mask`` the pixels to count, all if not given."""

    depth: Depth[Array, "H W"]
    confidence: Confidence[Array, "H W"]
    truth: Depth[Array, "H W"]
    mask: Mask[Array, "H W"] | None = None


class ConfidenceScoreOutputs(Ports):
    """See :func:`confidence_scores`."""

    ause: float
    risk90: float


class ConfidenceScore(Module[Params, ConfidenceScoreInputs, ConfidenceScoreOutputs]):
    """Whether confidence orders depth by its error: area under the sparsification error, risk at 90 % density.

    Reference: Ilg et al. 2018, doi:10.1007/978-3-030-01234-2_40.
    """

    name = "confidence_score"

    def run(self, inputs: ConfidenceScoreInputs, ctx: Context) -> ConfidenceScoreOutputs:
        """The two numbers, of absolute depth errors."""
        ctx.check()
        error = np.abs(inputs.depth - inputs.truth)
        return ConfidenceScoreOutputs.model_validate(confidence_scores(error, inputs.confidence, inputs.mask))
