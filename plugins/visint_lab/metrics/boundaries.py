"""Boundaries: precision, recall and their harmonic mean within a tolerance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries
from visint.module import Context, Module, Params, Ports
from visint_lab.metrics.counted import mean

__all__ = ["BoundaryScore", "boundary_scores", "distance_to"]


def distance_to(lines: Array) -> Array:
    """float64 (H, W): distance in pixels to the nearest set pixel of ``lines`` (bool), infinite if none is."""
    from scipy.ndimage import distance_transform_edt

    if not lines.any():
        return np.full(lines.shape, np.inf)
    return np.asarray(distance_transform_edt(~lines))


def boundary_scores(boundaries: Array, truth: Array, tolerance: float = 2.0) -> Mapping[str, float]:
    """``precision``: found pixels that lie within ``tolerance`` px of a true one; ``recall``: true pixels
    that lie so near a found one; ``f``: their harmonic mean, 0 if nothing is found.

    ``boundaries`` and ``truth`` are bool (H, W). Without true boundaries recall and f are NaN.
    """
    precision = mean(distance_to(truth)[boundaries] <= tolerance)
    recall = mean(distance_to(boundaries)[truth] <= tolerance)
    found = np.nan_to_num(precision)
    f = 2 * found * recall / (found + recall) if found + recall > 0 else recall
    return {"precision": precision, "recall": recall, "f": float(f)}


class BoundaryScoreParams(Params):
    """``tolerance``: how far a boundary may lie from the true one, full-size pixels; larger forgives more."""

    tolerance: float = Field(2.0, ge=0)


class BoundaryScoreInputs(Ports):
    """Boundaries and their truth."""

    boundaries: Boundaries[Array, "H W"]
    truth: Boundaries[Array, "H W"]


class BoundaryScoreOutputs(Ports):
    """See :func:`boundary_scores`."""

    precision: float
    recall: float
    f: float


class BoundaryScore(Module[BoundaryScoreParams, BoundaryScoreInputs, BoundaryScoreOutputs]):
    """How well boundaries meet the true ones: precision, recall and F within a tolerance of 2 px."""

    name = "boundary_score"

    def run(self, inputs: BoundaryScoreInputs, ctx: Context) -> BoundaryScoreOutputs:
        """The three numbers."""
        tolerance = self.params.tolerance / ctx.scale
        return BoundaryScoreOutputs.model_validate(boundary_scores(inputs.boundaries, inputs.truth, tolerance))
