"""``grouping.guide``: a surface for a second matching to follow."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.fields import DisparityEvidence
from visint.module import Context, Module, Params, Ports

__all__ = ["Guide"]

LEAST = 0.004
"""Reliability where nothing is to be changed: it costs nothing, and says how the surface runs."""


class GuideParams(Params):
    """Parameters of ``grouping.guide``.

    Parameters
    ----------
    doubt
        Doubt (1 - reliability) in the first matching from which a plane counts in full; below it counts less,
        in proportion. Less overrides surer matches.
    filled
        How much the first matching counts for the second where it has doubts and no plane speaks. More keeps
        what was filled in.
    """

    doubt: float = Field(default=0.6, gt=0, le=1)
    filled: float = Field(default=0.15, ge=0, le=1)


class GuideInputs(Ports):
    """The first matching, and the planes fitted to it."""

    evidence: DisparityEvidence
    planes: DisparityEvidence


class GuideOutputs(Ports):
    """``prior``: the plane where one speaks, else the matching; its reliability says how strongly to follow."""

    prior: DisparityEvidence


class Guide(Module[GuideParams, GuideInputs, GuideOutputs]):
    """What ``stereo.sgm`` is to follow in a second pass: planes, the more the less the first pass was sure.

    The reliability given is a weight, not a chance: where the first pass was sure it is next to 0, so that the
    second remains free, but climbs with the surface.
    """

    name = "guide"
    assumptions = ("smoothness",)

    def run(self, inputs: GuideInputs, ctx: Context) -> GuideOutputs:
        """The surface and its weight."""
        ctx.check()
        first, planes = inputs.evidence, inputs.planes
        plane = planes.reliability > 0
        doubts = np.minimum((1 - first.reliability) / self.params.doubt, 1)
        weight = np.maximum(np.where(plane, 1.0, self.params.filled) * doubts, LEAST)
        value = np.where(plane, planes.value, first.value)
        return GuideOutputs(prior=DisparityEvidence.of(value, 1.0, weight))
