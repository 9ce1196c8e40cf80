"""``bayes.pointwise``: all evidence on depth together, pixel by pixel, Eq. 5.10."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from visint.arrays import Array, Confidence, Depth, Sigma
from visint.fields import Camera, DepthEvidence, DisparityEvidence
from visint.fields.geometry import depth_evidence
from visint.module import Context, Module, Params, Ports
from visint_bayes.sureness import confidence_of, depth_per_pixel

__all__ = ["Pointwise"]


class PointwiseParams(Params):
    """Nothing to choose: the weights are the variances."""


class PointwiseInputs(Ports):
    """Evidence of any number of cues, and the map, which stays where none speaks; camera: else 53° of view."""

    depth_evidence: tuple[DepthEvidence, ...] = ()
    disparity_evidence: tuple[DisparityEvidence, ...] = ()
    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"] | None = None
    camera: Camera | None = None


class PointwiseOutputs(Ports):
    """The fused depth, its confidence, and its standard deviation in the unit of the baseline (NaN: no cue)."""

    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"]
    sigma: Sigma[Array, "H W"]


class Pointwise(Module[PointwiseParams, PointwiseInputs, PointwiseOutputs]):
    """The maximum a posteriori depth of independent cues with Gaussian noise and no prior.

    Eq. 5.10: the mean of what they say weighted by 1/variance; its variance is one over the sum of the weights.
    A cue's variance is σ² / reliability, so one that is half sure counts half. Wants its place under
    ``hub.reconcile``, where it gets all evidence of a sweep at once.

    Assumes that errors are independent, between cues and between pixels: nothing is smoothed.
    """

    name = "pointwise"
    assumptions = ("gaussian_noise",)

    def run(self, inputs: PointwiseInputs, ctx: Context) -> PointwiseOutputs:
        """One fused map."""
        ctx.check()
        rows, columns = inputs.depth.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        weighted, weights = np.zeros((rows, columns)), np.zeros((rows, columns))
        for evidence in _all(inputs, camera):
            speaks = evidence.reliability > 0
            weight = np.zeros((rows, columns))
            np.divide(
                evidence.reliability, np.square(evidence.sigma, dtype=np.float64), out=weight, where=speaks
            )
            weights += weight
            weighted += np.where(speaks, weight * evidence.value, 0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            fused = np.where(weights > 0, weighted / weights, inputs.depth).astype(np.float32)
            sigma = np.where(weights > 0, 1 / np.sqrt(weights), np.nan).astype(np.float32)
            pixels = np.float32(ctx.scale) * sigma / depth_per_pixel(fused, camera)
            sure = confidence_of(np.square(pixels))
        before = np.zeros_like(fused) if inputs.depth_confidence is None else inputs.depth_confidence
        confidence = np.where(weights > 0, sure, before)
        return PointwiseOutputs(depth=fused, depth_confidence=confidence, sigma=sigma)


def _all(inputs: PointwiseInputs, camera: Camera) -> Iterator[DepthEvidence]:
    yield from inputs.depth_evidence
    yield from (depth_evidence(each, camera) for each in inputs.disparity_evidence)
