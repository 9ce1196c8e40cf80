"""Line labels: which arcs and junctions of a drawing are labelled right."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydantic import Field

from visint.arrays import Array, Regions
from visint.module import Context, Module, Params, Ports
from visint_lab.metrics.counted import mean

__all__ = ["LabelScore", "arc_scores", "junction_scores"]


def arc_scores(arcs: Array, labels: Array, truth: Array, tolerance: float = 2.0) -> Mapping[str, float]:
    """``right``: the share of arcs that carry the label most true edge pixels along them have; ``pixels``: the
    share of arc pixels whose label is that of the nearest true edge pixel.

    Parameters
    ----------
    arcs
        int32 (H, W): number of the arc through a pixel, from 1; 0 elsewhere.
    labels
        int32 (H, W): the label the drawing gives it, coded as in :mod:`visint_lab.render.edges`.
    truth
        int32 (H, W): the true label, 0 where there is no edge.
    tolerance
        How far an arc may lie from the true edge, px. An arc that lies along none is wrong.
    """
    found = _nearest_labels(truth, tolerance)
    on = arcs > 0
    if not on.any():
        return {"right": float("nan"), "pixels": float("nan")}
    span = int(max(found.max(), labels.max())) + 1
    votes = np.bincount(arcs[on] * span + found[on], minlength=(int(arcs.max()) + 1) * span).reshape(-1, span)
    given = np.bincount(arcs[on] * span + labels[on], minlength=votes.size).reshape(-1, span)
    present = votes.sum(axis=1) > 0
    true_label, given_label = votes.argmax(axis=1)[present], given.argmax(axis=1)[present]
    right = (true_label == given_label) & (true_label > 0)
    return {"right": mean(right), "pixels": mean((found == labels)[on] & (found > 0)[on])}


def _nearest_labels(truth: Array, tolerance: float) -> Array:
    """The label of the nearest true edge pixel, 0 if it is further than ``tolerance``."""
    from scipy.ndimage import distance_transform_edt

    if not (truth > 0).any():
        return np.zeros(truth.shape, dtype=np.int64)
    distance, nearest = distance_transform_edt(truth == 0, return_indices=True)
    return np.where(distance <= tolerance, truth[tuple(nearest)], 0).astype(np.int64)


def junction_scores(found: Array, truth: Array, tolerance: float = 5.0) -> Mapping[str, float]:
    """``right``: the share of true junctions met by a found one of their type within ``tolerance`` px;
    ``found``: the share met by one of any type; ``extra``: found junctions that meet none, a true one.

    ``found`` and ``truth`` are (N, 3): row, column, type. Each found junction serves once, nearest first.
    """
    from scipy.optimize import linear_sum_assignment

    if not len(truth):
        return {"right": float("nan"), "found": float("nan"), "extra": float("nan")}
    gap = np.linalg.norm(truth[:, None, :2] - found[None, :, :2], axis=-1)
    rows, columns = linear_sum_assignment(np.minimum(gap, 1e3 * tolerance))
    met = gap[rows, columns] <= tolerance
    same = truth[rows, 2] == found[columns, 2]
    total = len(truth)
    return {
        "right": float((met & same).sum() / total),
        "found": float(met.sum() / total),
        "extra": float((len(found) - met.sum()) / total),
    }


class LabelScoreParams(Params):
    """``tolerance``: how far, in full-size pixels, an arc may lie from the true edge; larger forgives more."""

    tolerance: float = Field(2.0, ge=0)


class LabelScoreInputs(Ports):
    """Numbered arcs, their labels and the true labels; see :func:`arc_scores`."""

    arcs: Regions[Array, "H W"]
    labels: Regions[Array, "H W"]
    truth: Regions[Array, "H W"]


class LabelScoreOutputs(Ports):
    """See :func:`arc_scores`."""

    right: float
    pixels: float


class LabelScore(Module[LabelScoreParams, LabelScoreInputs, LabelScoreOutputs]):
    """How many arcs of a line drawing are labelled as the scene says."""

    name = "label_score"

    def run(self, inputs: LabelScoreInputs, ctx: Context) -> LabelScoreOutputs:
        """The two shares."""
        tolerance = self.params.tolerance / ctx.scale
        return LabelScoreOutputs.model_validate(arc_scores(inputs.arcs, inputs.labels, inputs.truth, tolerance))
