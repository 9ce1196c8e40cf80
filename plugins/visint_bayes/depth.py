"""``bayes.depth``: the consistency mapping of cues that constrain depth itself, Eq. 5.48."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence
from visint.arrays import Depth as DepthMap
from visint.fields import Camera, DepthEvidence, DisparityEvidence, barriers
from visint.fields.geometry import depth_from_disparity, disparity_evidence
from visint.module import Context, Module, Params, Ports
from visint_bayes.sureness import confidence_of, disparity_of, variance_of

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

    The confidence is that of the Kalman filter whose gain this is: what the neighbours predict has their mean
    variance v̄ + 1/λ, the evidence R = σ²/reliability, and the new variance is 1/(1/(v̄ + 1/λ) + 1/R). So it
    grows by 1/λ a pixel away from evidence, and twenty looks at the same images do not pass for twenty
    measurements.
    """

    name = "depth"
    assumptions = ("smoothness", "gaussian_noise")

    def run(self, inputs: DepthInputs, ctx: Context) -> DepthOutputs:
        """The map after this cue."""
        ctx.check()
        rows, columns = inputs.depth.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        before = disparity_of(inputs.depth, camera)
        said, beta = self._evidence(inputs, camera)
        around = Around.of(before, inputs.boundaries)
        after = self._moved(_Terms(said, beta, before, around), ctx)
        depth = depth_from_disparity(after, camera)
        kept = np.where(np.isnan(depth), inputs.depth, depth)
        return DepthOutputs(depth=kept, depth_confidence=self._confidence(inputs, beta, around, ctx.scale))

    def _evidence(self, inputs: DepthInputs, camera: Camera) -> tuple[Array, Array]:
        """(disparity, β) with 0 for what is not said."""
        evidence = inputs.disparity_evidence
        if evidence is None and inputs.depth_evidence is not None:
            evidence = disparity_evidence(inputs.depth_evidence, camera)
        if evidence is None:
            nothing = np.zeros(inputs.depth.shape, np.float32)
            return nothing, nothing
        speaks = evidence.reliability > 0
        sigma = np.maximum(np.where(speaks, evidence.sigma, np.float32(1)), np.float32(self.params.sharpest))
        return np.where(speaks, evidence.value, np.float32(0)), evidence.reliability / (sigma * sigma)

    def _moved(self, terms: _Terms, ctx: Context) -> Array:
        weight = np.float32(self.params.smoothness / 4)
        if self.params.solve == "step":
            pull = weight * terms.around.number
            total = terms.beta + pull
            mean = np.where(terms.around.number > 0, terms.around.mean, np.float32(0))
            with np.errstate(divide="ignore", invalid="ignore"):
                moved = (terms.beta * terms.said + pull * mean) / total
            return np.where(total > 0, moved, terms.before)
        from visint_bayes import _kernels

        after = np.where(np.isnan(terms.before), terms.said, terms.before)
        reached = terms.around.reached
        steps = _kernels.solve(terms.said, terms.beta, reached, weight, self.params.tolerance, after)
        ctx.measure("steps", steps)
        return after

    def _confidence(self, inputs: DepthInputs, beta: Array, around: Around, scale: int) -> Array:
        """The map's confidence after the filter's step; variances in full-size px²."""
        square = np.float32(scale * scale)
        sure = inputs.depth_confidence
        variance = variance_of(np.zeros_like(inputs.depth) if sure is None else sure)
        mean, count = barriers.mean(np.where(np.isinf(variance), np.float32(1e12), variance), around.reached)
        predicted = np.where(count > 0, mean + square / np.float32(self.params.smoothness), variance)
        with np.errstate(divide="ignore"):
            precision = 1 / predicted + beta / square
            return confidence_of(1 / precision)


class Around(NamedTuple):
    """The four neighbours on the same side: ``mean`` (NaN without any), their ``number``, and the links."""

    mean: Array
    number: Array
    reached: Array

    @classmethod
    def of(cls, field: Array, boundaries: Array | None) -> Around:
        """Of ``field`` float32 (H, W)."""
        reached = barriers.links_within(boundaries, field)
        mean, number = barriers.mean(field, reached)
        return cls(mean, number, reached)


class _Terms(NamedTuple):
    """What the new disparity is made of, float32 (H, W) each."""

    said: Array
    beta: Array
    before: Array
    around: Around
