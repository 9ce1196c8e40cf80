"""Shape: differences of unit normals."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from visint.arrays import Array, Mask, Normals
from visint.fields.evidence import known
from visint.module import Context, Module, Params, Ports
from visint_lab.metrics.counted import counted, mean, share

__all__ = ["ShapeScore", "shape_scores"]


def shape_scores(normals: Array, truth: Array, mask: Array | None = None) -> Mapping[str, float]:
    """``s``, the mean squared difference of unit normals (H, W, 3) (0 to 4), the ``mean_angle`` and
    ``median_angle`` between them in radians, and the ``density`` of what is known.
    """
    where = counted(truth, mask)
    there = known(normals)
    difference = (normals.astype(np.float64) - truth)[where & there]
    squared = (difference**2).sum(axis=-1)
    # |a − b| = 2 sin(angle/2) is exact also for small angles, where arccos of a float32 product is not.
    angle = 2 * np.arcsin(np.clip(np.sqrt(squared) / 2, 0, 1))
    median = float(np.median(angle)) if angle.size else float("nan")
    return {
        "s": mean(squared),
        "mean_angle": mean(angle),
        "median_angle": median,
        "density": share(there, where),
    }


class ShapeScoreInputs(Ports):
    """Normals and their truth; ``mask`` the pixels to count, all if not given."""

    normals: Normals[Array, "H W 3"]
    truth: Normals[Array, "H W 3"]
    mask: Mask[Array, "H W"] | None = None


class ShapeScoreOutputs(Ports):
    """See :func:`shape_scores`."""

    s: float
    mean_angle: float
    median_angle: float
    density: float


class ShapeScore(Module[Params, ShapeScoreInputs, ShapeScoreOutputs]):
    """How far normals lie from the truth: mean squared difference of unit vectors, mean and median angle."""

    name = "shape_score"

    def run(self, inputs: ShapeScoreInputs, ctx: Context) -> ShapeScoreOutputs:
        """The four numbers over the counted pixels."""
        ctx.check()
        return ShapeScoreOutputs.model_validate(shape_scores(inputs.normals, inputs.truth, inputs.mask))
