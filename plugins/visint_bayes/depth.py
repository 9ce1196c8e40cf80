"""``bayes.depth``: the consistency mapping of cues that constrain depth itself, Eq. 5.48."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence
from visint.arrays import Depth as DepthMap
from visint.fields import Camera, DepthEvidence, DisparityEvidence, barriers
from visint.fields.geometry import depth_from_disparity, disparity_evidence
from visint.module import Context, Module, Params, Ports
from visint_bayes.sureness import disparity_of

__all__ = ["Depth"]


class DepthParams(Params):
    """Parameters of ``bayes.depth``.

    Parameters
    ----------
    smoothness
        λ_s, px⁻² of the level: the mean of four neighbours predicts a disparity to 1/√λ_s px. More smooths
        more. A cue counts with its reliability / σ², in the same unit.
    sharpest
        σ is taken for at least this, px: matches have errors that no model of noise knows.
    solve
        ``step``: one Jacobi step from the map, as published; ``solved``: the minimum of Eq. 5.47, so that what
        is known spreads through the whole region at once.
    tolerance
        Of the solution: residual, relative.
    """

    smoothness: float = Field(default=4.0, gt=0)
    sharpest: float = Field(default=0.1, gt=0)
    solve: Literal["step", "solved"] = "step"
    tolerance: float = Field(default=1e-4, gt=0, lt=1)


class DepthInputs(Ports):
    """Validated evidence, on depth or disparity, and the map; without a camera 53° of view."""

    depth_evidence: DepthEvidence | None = None
    disparity_evidence: DisparityEvidence | None = None
    depth: DepthMap[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    camera: Camera | None = None


class DepthOutputs(Ports):
    """The map's new depth, and how sure it is: 1/(1 + variance of the disparity in full-size px²)."""

    depth: DepthMap[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"]


class Depth(Module[DepthParams, DepthInputs, DepthOutputs]):
    """Depth drawn towards validated evidence and the mean of its neighbours on the same side.

    Eq. 5.48, D = (β D_st + λ D̄) / (β + λ), in disparity, where planes are linear and the precision β has one
    unit with λ (in depth it has not). Missing neighbours take their share of λ away, as the derivatives of
    Eqs. 5.39 and 5.40 do; where neither evidence nor neighbour speaks, the map stays.

    The confidence is that of the Kalman filter whose gain this is: what the neighbours predict has the variance
    v̄ + 1/λ (v̄ that of their mean confidence), the evidence R = σ²/reliability, and the new variance is
    1/(1/(v̄ + 1/λ) + 1/R). So it grows by 1/λ a pixel away from evidence, and twenty looks at the same images do
    not pass for twenty measurements.
    """

    name = "depth"
    assumptions = ("smoothness", "gaussian_noise")

    def run(self, inputs: DepthInputs, ctx: Context) -> DepthOutputs:
        """The map after this cue."""
        from visint_bayes import _kernels

        ctx.check()
        rows, columns = inputs.depth.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        said = _evidence(inputs, camera)
        before = disparity_of(inputs.depth, camera)
        reached = barriers.links_within(inputs.boundaries, before)
        sure = np.zeros_like(before) if inputs.depth_confidence is None else inputs.depth_confidence
        after, confidence = np.empty_like(before), np.empty_like(before)
        strengths = np.array([self.params.smoothness, self.params.sharpest, ctx.scale**2], np.float32)
        told = (said.value, said.sigma, said.reliability)
        _kernels.step(*told, before, sure, reached, strengths, after, confidence)
        if self.params.solve == "solved":
            after = self._solved(said, before, reached, ctx)
        depth = depth_from_disparity(after, camera)
        return DepthOutputs(depth=np.where(np.isnan(depth), inputs.depth, depth), depth_confidence=confidence)

    def _solved(self, said: DisparityEvidence, before: Array, reached: Array, ctx: Context) -> Array:
        from visint_bayes import _kernels

        speaks = said.reliability > 0
        sigma = np.maximum(np.where(speaks, said.sigma, np.float32(1)), np.float32(self.params.sharpest))
        value = np.where(speaks, said.value, np.float32(0))
        after = np.where(np.isnan(before), value, before)
        numbers = (np.float32(self.params.smoothness / 4), self.params.tolerance)
        steps = _kernels.solve(value, said.reliability / (sigma * sigma), reached, *numbers, after)
        ctx.measure("steps", steps)
        return after


def _evidence(inputs: DepthInputs, camera: Camera) -> DisparityEvidence:
    """What is said, as disparity; silent where nothing came."""
    if inputs.disparity_evidence is not None:
        return inputs.disparity_evidence
    if inputs.depth_evidence is not None:
        return disparity_evidence(inputs.depth_evidence, camera)
    return DisparityEvidence.of(np.full(inputs.depth.shape, np.nan, np.float32), 1.0, 0.0)
