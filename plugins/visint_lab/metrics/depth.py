"""Depth: squared and absolute errors, in the unit of the baseline."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from visint.arrays import Array, Depth, Mask
from visint.module import Context, Module, Params, Ports
from visint_lab.metrics.counted import counted, mean, share

__all__ = ["DepthScore", "depth_scores"]


def depth_scores(depth: Array, truth: Array, mask: Array | None = None) -> Mapping[str, float]:
    """``mse``, ``rmse``, ``median`` absolute error and ``density`` of depth (H, W) against ``truth``.

    The errors are over the counted pixels where depth is known; ``density`` says how many of them those are.
    """
    where = counted(truth, mask)
    there = np.isfinite(depth)
    error = np.abs(depth.astype(np.float64) - truth)[where & there]
    mse = mean(error**2)
    median = float(np.median(error)) if error.size else float("nan")
    return {"mse": mse, "rmse": mse**0.5, "median": median, "density": share(there, where)}


class DepthScoreInputs(Ports):
    """A depth map and its truth; ``mask`` the pixels to count, all if not given."""

    depth: Depth[Array, "H W"]
    truth: Depth[Array, "H W"]
    mask: Mask[Array, "H W"] | None = None


class DepthScoreOutputs(Ports):
    """See :func:`depth_scores`."""

    mse: float
    rmse: float
    median: float
    density: float


class DepthScore(Module[Params, DepthScoreInputs, DepthScoreOutputs]):
    """How far a depth map lies from the truth: mean squared, root mean squared and median absolute error."""

    name = "depth_score"

    def run(self, inputs: DepthScoreInputs, ctx: Context) -> DepthScoreOutputs:
        """The four numbers over the counted pixels."""
        ctx.check()
        return DepthScoreOutputs.model_validate(depth_scores(inputs.depth, inputs.truth, inputs.mask))
