"""Disparity: shares of wrong pixels, mean absolute error, density."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from visint.arrays import Array, Disparity, Mask
from visint.module import Context, Module, Params, Ports
from visint_lab.metrics.counted import counted, mean, share

__all__ = ["DisparityScore", "disparity_scores", "filled_from_rows"]


def disparity_scores(disparity: Array, truth: Array, mask: Array | None = None) -> Mapping[str, float]:
    """``bad1`` and ``bad2``, the shares of pixels off by more than 1 and 2 px, ``mae`` in px, ``density``.

    An unknown pixel is wrong for ``bad1`` and ``bad2`` and left out of ``mae``: fill holes first to compare
    methods that leave different ones (:func:`filled_from_rows`).
    """
    where = counted(truth, mask)
    error = np.abs(disparity.astype(np.float64) - truth)
    there = np.isfinite(error)
    return {
        "bad1": share(~(error <= 1), where),
        "bad2": share(~(error <= 2), where),
        "mae": mean(error[where & there]),
        "density": share(there, where),
    }


def filled_from_rows(disparity: Array) -> Array:
    """float32 (H, W) without holes: each takes the smaller of the nearest known values left and right of it.

    The smaller one because holes are mostly half-occluded background. A row without any known value takes
    those of the nearest row that has some; a map that knows nothing becomes 0.
    """
    from_left = _carried(disparity)
    from_right = _carried(disparity[:, ::-1])[:, ::-1]
    filled = np.fmin(from_left, from_right)
    rows = np.nonzero(np.isfinite(filled[:, 0]))[0]
    if not rows.size:
        return np.zeros_like(disparity)
    nearest = rows[np.abs(np.arange(len(filled))[:, None] - rows).argmin(axis=1)]
    return np.ascontiguousarray(filled[nearest], dtype=np.float32)


def _carried(values: Array) -> Array:
    """Each unknown value replaced by the last known one to its left."""
    place = np.where(np.isfinite(values), np.arange(values.shape[1]), -1)
    last = np.maximum.accumulate(place, axis=1)
    carried = np.take_along_axis(values, np.maximum(last, 0), axis=1)
    return np.where(last < 0, np.nan, carried)


class DisparityScoreInputs(Ports):
    """A disparity map and its truth; ``mask`` the pixels to count, all if not given."""

    disparity: Disparity[Array, "H W"]
    truth: Disparity[Array, "H W"]
    mask: Mask[Array, "H W"] | None = None


class DisparityScoreOutputs(Ports):
    """See :func:`disparity_scores`."""

    bad1: float
    bad2: float
    mae: float
    density: float


class DisparityScore(Module[Params, DisparityScoreInputs, DisparityScoreOutputs]):
    """How far a disparity map lies from the truth: bad-1.0, bad-2.0, mean absolute error, density."""

    name = "disparity_score"

    def run(self, inputs: DisparityScoreInputs, ctx: Context) -> DisparityScoreOutputs:
        """The four numbers over the counted pixels."""
        ctx.check()
        return DisparityScoreOutputs.model_validate(
            disparity_scores(inputs.disparity, inputs.truth, inputs.mask)
        )
