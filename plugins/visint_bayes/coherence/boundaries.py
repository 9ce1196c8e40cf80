"""``bayes.cohere_boundaries``: whether a line of the image is a boundary in space."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence, Disparity
from visint.arrays import Boundaries as Lines
from visint.fields import BoundariesEvidence
from visint.module import Context, Module, Params, Ports

__all__ = ["CohereBoundaries"]

MOST = 1500
"""Regions above which nothing is judged: pairs of them would not fit."""


class CohereBoundariesParams(Params):
    """Parameters of ``bayes.cohere_boundaries``.

    Parameters
    ----------
    jump
        Disparity, px of the level, that the two sides of a boundary must miss each other by. More drops more.
    bend
        Change of the disparity's slope, px per px of the level, that makes a crease. More drops more.
    trusted
        How sure the map has to be of its depth on both sides before it may say that nothing is there.
    reach
        How far it looks to either side, px of the level.
    """

    jump: float = Field(default=0.5, ge=0)
    bend: float = Field(default=0.15, ge=0)
    trusted: float = Field(default=0.5, ge=0, le=1)
    reach: int = Field(default=4, ge=2, le=32)


class CohereBoundariesInputs(Ports):
    """What grouping says, and the map's disparity with the confidence of its depth."""

    evidence: BoundariesEvidence
    disparity: Disparity[Array, "H W"] | None = None
    depth_confidence: Confidence[Array, "H W"] | None = None


class CohereBoundariesOutputs(Ports):
    """The boundaries that may be some in space, and the lines that only mark a surface."""

    evidence: BoundariesEvidence
    marks: Lines[Array, "H W"]


class CohereBoundaries(Module[CohereBoundariesParams, CohereBoundariesInputs, CohereBoundariesOutputs]):
    """Boundaries of the image across which a sure map is one smooth surface are dropped: they are marks on it.

    Chapter 5 wants boundaries in space of grouping, and coherence to refine the segmentation, but gives no
    rule. Here two regions are asked what they predict at their common border: on the average along it, either
    side is continued straight to the line, and where the two neither miss each other nor bend, and the map is
    sure on both sides, the line is taken back. As long as the map is not sure it stays.

    Assumes that a border is of one kind all along.
    """

    name = "cohere_boundaries"
    assumptions = ("coherence", "smoothness")

    def run(self, inputs: CohereBoundariesInputs, ctx: Context) -> CohereBoundariesOutputs:
        """Evidence of the images' size; where a line was dropped it says so, no less surely."""
        import cv2

        ctx.check()
        said = inputs.evidence.value
        nothing = np.zeros_like(said)
        if inputs.disparity is None or inputs.depth_confidence is None:
            return CohereBoundariesOutputs(evidence=inputs.evidence, marks=nothing)
        count, labels = cv2.connectedComponents((~said).astype(np.uint8), connectivity=4)
        if count > MOST:
            return CohereBoundariesOutputs(evidence=inputs.evidence, marks=nothing)
        kept = self._kept(inputs, said, labels, count)
        marks = said & ~kept
        ctx.measure("marks", float(marks.sum()))
        found = inputs.evidence
        trust = np.where(marks, 1 - (1 - found.reliability) * np.float32(0.5), found.reliability)
        evidence = BoundariesEvidence.of(
            kept, np.where(trust > 0, np.nan_to_num(found.sigma, nan=1.0), 1.0), trust
        )
        return CohereBoundariesOutputs(evidence=evidence, marks=marks)

    def _kept(self, inputs: CohereBoundariesInputs, said: Array, labels: Array, count: int) -> Array:
        import cv2

        from visint_bayes.coherence import _kernels

        seen, step, bend, trust = np.zeros((4, count, count))
        given = (said, labels, inputs.disparity, inputs.depth_confidence)
        _kernels.across_lines(*given, self.params.reach, seen, step, bend, trust)
        with np.errstate(divide="ignore", invalid="ignore"):
            step, bend, trust = (np.where(seen > 0, each / seen, 0) for each in (step, bend, trust))
        smooth = (np.abs(step) < self.params.jump) & (np.abs(bend) < self.params.bend)
        kept, closed = np.zeros_like(said), np.zeros_like(said)
        _kernels.still_between(said, labels, smooth & (trust > self.params.trusted), kept)
        _, left = cv2.connectedComponents((~kept).astype(np.uint8), connectivity=4)
        _kernels.still_between(kept, left, np.zeros((left.max() + 1,) * 2, dtype=bool), closed)
        return closed
