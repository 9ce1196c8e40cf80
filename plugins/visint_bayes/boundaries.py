"""``bayes.boundaries``: the consistency mapping of boundaries, Eq. 5.25."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence
from visint.arrays import Boundaries as Lines
from visint.fields import BoundariesEvidence
from visint.module import Context, Module, Params, Ports

__all__ = ["Boundaries"]


class BoundariesParams(Params):
    """Parameters of ``bayes.boundaries``.

    Parameters
    ----------
    reach
        Half the side of the neighbourhood N, full-size pixels. More joins lines that lie further apart, and
        shortens free ends by about half of it.
    keep
        A boundary of the map that the evidence does not confirm is dropped when its weight, its confidence
        times what is left of it after the evidence's denial, is below this. 0 keeps everything for ever.
    """

    reach: float = Field(default=2.0, ge=0, le=16)
    keep: float = Field(default=0.2, ge=0, le=1)


class BoundariesInputs(Ports):
    """The evidence, and the map's boundaries with their confidence."""

    evidence: BoundariesEvidence
    boundaries: Lines[Array, "H W"] | None = None
    boundaries_confidence: Confidence[Array, "H W"] | None = None


class BoundariesOutputs(Ports):
    """The map's new boundaries, and how sure it is of each pixel being one, or being none."""

    boundaries: Lines[Array, "H W"]
    boundaries_confidence: Confidence[Array, "H W"]


class _Sites(NamedTuple):
    """The set S of Eq. 5.25: where boundaries are said to be, and the weight β of each."""

    lines: Array
    weight: Array


class Boundaries(Module[BoundariesParams, BoundariesInputs, BoundariesOutputs]):
    """Boundaries of the map and of the evidence drawn together, each to the weighted mean of its neighbourhood.

    Eq. 5.25 in its corrected reading: a squared norm in Eq. 5.24, whose minimum is the mean of the sites of
    both within N, weighted by their coherence β and divided by Σβ, rounded to the pixel (after C.-C. Chu
    and J. K. Aggarwal, PAMI 15(12), 1993, who combine segmentations so). Steps along a line are filled where
    rounding would break it, so what was closed stays closed.
    """

    name = "boundaries"

    def run(self, inputs: BoundariesInputs, ctx: Context) -> BoundariesOutputs:
        """One step; it needs no other, the next turn brings new evidence."""
        from visint_bayes import _kernels

        ctx.check()
        sites = self._sites(inputs)
        lines = np.zeros_like(sites.lines)
        sure = np.zeros(lines.shape, np.float32)
        reach = max(round(self.params.reach / ctx.scale), 1) if self.params.reach else 0
        _kernels.draw_together(sites.lines, sites.weight, reach, lines, sure)
        denied = np.where(inputs.evidence.value, np.float32(0), inputs.evidence.reliability)
        return BoundariesOutputs(boundaries=lines, boundaries_confidence=np.where(lines, sure, denied))

    def _sites(self, inputs: BoundariesInputs) -> _Sites:
        evidence = inputs.evidence
        said = evidence.value & (evidence.reliability > 0)
        if inputs.boundaries is None:
            return _Sites(said, np.where(said, evidence.reliability, np.float32(0)))
        sure = inputs.boundaries_confidence
        before = np.ones(said.shape, np.float32) if sure is None else sure
        left = before * np.where(evidence.value, np.float32(1), 1 - evidence.reliability)
        old = inputs.boundaries & (said | (left >= self.params.keep))
        old &= left > 0
        weight = np.where(said, evidence.reliability, np.float32(0)) + np.where(old, left, np.float32(0))
        return _Sites(said | old, weight)
