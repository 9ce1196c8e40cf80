"""``bayes.cohere_disparity`` and ``bayes.cohere_depth``: where matches agree with those around them."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence, Depth, Disparity
from visint.fields import Camera, DepthEvidence, DisparityEvidence
from visint.fields.geometry import depth_evidence, disparity_evidence, disparity_from_depth
from visint.module import Context, Module, Params, Ports
from visint_bayes.coherence.table import REJECTED, Opinions, Verdict, validated

__all__ = ["CohereDepth", "CohereDisparity"]

NEIGHBOURS = 4
"""Stereo's neighbourhood, as published."""


class CohereDisparityParams(Params):
    """Parameters of ``bayes.cohere_disparity`` and ``bayes.cohere_depth``.

    Parameters
    ----------
    rho
        Variance of the neighbours' predictions, px² of the level, above which they do not agree. Less keeps
        more of the map and follows the cue less. Published: at most 4.
    """

    rho: float = Field(default=4.0, gt=0)


class CohereDisparityInputs(Ports):
    """A cue's disparity, the other view's, and the map's.

    ``back``: the right view's disparity (of ``stereo.weng`` its output ``right``). With it a neighbour's
    prediction is where its match leads back to; without, the neighbour's disparity itself.
    """

    evidence: DisparityEvidence
    back: Disparity[Array, "H W"] | None = None
    disparity: Disparity[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None


class CohereDisparityOutputs(Ports):
    """Validated disparity; how sure it is that neighbours agree (``beta``), and with the map (``kappa``)."""

    evidence: DisparityEvidence
    beta: Confidence[Array, "H W"]
    kappa: Confidence[Array, "H W"]


class CohereDisparity(Module[CohereDisparityParams, CohereDisparityInputs, CohereDisparityOutputs]):
    """Disparity validated by what the four neighbours' matches predict for a pixel.

    Eqs. 5.30 and 5.31 in their corrected reading: the positions that matches lead back to are turned into
    disparities; where their variance exceeds ρ the map's value stands; where it does not with the map's value
    among them, the median of all; else the median of the neighbours. Neighbours across a boundary are not
    asked. Reliability is the mean of the neighbours' times β, and falls the further their matches lead back
    from the pixel itself: behind an edge that one view alone sees past, neighbours agree on the wrong surface.
    """

    name = "cohere_disparity"
    assumptions = ("coherence", "local_spatial_interaction")

    def run(self, inputs: CohereDisparityInputs, ctx: Context) -> CohereDisparityOutputs:
        """Evidence of the images' size; it may speak where the cue itself did not, and its neighbours do."""
        ctx.check()
        verdict = _judged(inputs.evidence, inputs, self.params.rho)
        ctx.assumed("coherence", verdict.agreement >= 0.5)
        value = verdict.value[..., 0]
        gap = np.nan_to_num(value - inputs.evidence.value, nan=0.0)
        far = np.where(verdict.row == REJECTED, np.float32(0), gap * gap)
        trust = verdict.trust / (1 + far / np.float32(self.params.rho))
        found = DisparityEvidence.of(value, verdict.sigma, trust)
        return CohereDisparityOutputs(evidence=found, beta=verdict.beta, kappa=verdict.kappa)


def _judged(evidence: DisparityEvidence, inputs: CohereDisparityInputs, rho: float) -> Verdict:
    own = evidence.value
    predicted = own if inputs.back is None else _led_back(inputs.back, own)
    known = inputs.disparity if inputs.disparity is not None else np.full_like(own, np.nan)
    predicted, own, known = (np.ascontiguousarray(each)[..., None] for each in (predicted, own, known))
    opinions = Opinions(predicted, own, known, evidence.reliability, evidence.sigma)
    return validated(opinions, inputs.boundaries, NEIGHBOURS, rho)


def _led_back(back: Array, own: Array) -> Array:
    from visint_bayes.coherence import _kernels

    found = np.empty_like(own)
    _kernels.carried_back(back, own, found)
    return found


class CohereDepthInputs(Ports):
    """A cue's depth, the map's depth and the camera; without one 53° of view."""

    evidence: DepthEvidence
    depth: Depth[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    camera: Camera | None = None


class CohereDepthOutputs(Ports):
    """Validated depth; how sure it is that neighbours agree (``beta``), and with the map (``kappa``)."""

    evidence: DepthEvidence
    beta: Confidence[Array, "H W"]
    kappa: Confidence[Array, "H W"]


class CohereDepth(Module[CohereDisparityParams, CohereDepthInputs, CohereDepthOutputs]):
    """Depth validated by its four neighbours': the rule of Eq. 5.31, in disparities.

    In disparity the surfaces that neighbours predict are planes at any distance, and ρ means the same near and
    far.
    """

    name = "cohere_depth"
    assumptions = ("coherence", "local_spatial_interaction")

    def run(self, inputs: CohereDepthInputs, ctx: Context) -> CohereDepthOutputs:
        """Evidence of the images' size."""
        ctx.check()
        rows, columns = inputs.evidence.value.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        evidence = disparity_evidence(inputs.evidence, camera)
        known = None if inputs.depth is None else disparity_from_depth(inputs.depth, camera)
        of_disparity = CohereDisparityInputs(evidence=evidence, disparity=known, boundaries=inputs.boundaries)
        found = CohereDisparity(self.params).run(of_disparity, ctx)
        back = depth_evidence(found.evidence, camera)
        return CohereDepthOutputs(evidence=back, beta=found.beta, kappa=found.kappa)
