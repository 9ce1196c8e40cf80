"""``bayes.cohere_normals``: where the orientations that a cue sees agree with those around them."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence, Depth, Normals
from visint.fields import Camera, Evidence, NormalsEvidence, ReliefEvidence, SlopesEvidence
from visint.fields.geometry import normals_from_slopes, slopes_from_depth
from visint.module import Context, Module, Params, Ports
from visint_bayes.coherence.table import Opinions, validated

__all__ = ["CohereNormals"]

NEIGHBOURS = 8
"""The neighbourhood of shading and texture, as published."""
DIFFERENCE = np.float32(0.7)
"""Sigma of half the difference of two values, of the values' own."""


class CohereNormalsParams(Params):
    """Parameters of ``bayes.cohere_normals``.

    Parameters
    ----------
    rho
        Variance of the neighbours' unit vectors, mean of the three components, above which they do not agree.
        Less keeps more of the map and follows the cue less. Published: at most 0.2.
    """

    rho: float = Field(default=0.2, gt=0)


class CohereNormalsInputs(Ports):
    """A cue's orientations, in one of three forms, and the map's.

    ``relief`` is differentiated as if it were depth, at the map's ``depth``; so are ``slopes`` turned into
    normals. Without a ``camera`` 53° of view; without depth only normals can be told.
    """

    normals_evidence: NormalsEvidence | None = None
    relief_evidence: ReliefEvidence | None = None
    slopes_evidence: SlopesEvidence | None = None
    depth: Depth[Array, "H W"]
    normals: Normals[Array, "H W 3"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    camera: Camera | None = None


class CohereNormalsOutputs(Ports):
    """Validated normals; how sure it is that neighbours agree (``beta``), and with the map (``kappa``)."""

    evidence: NormalsEvidence
    beta: Confidence[Array, "H W"]
    kappa: Confidence[Array, "H W"]


class CohereNormals(Module[CohereNormalsParams, CohereNormalsInputs, CohereNormalsOutputs]):
    """Orientations validated by their eight neighbours.

    Eqs. 5.51 and 5.52 in their corrected reading: where the variance of the neighbours' unit normals (mean of
    the components') exceeds ρ the map's normal stands; where it does not with the map's among them, the median
    of all; else the neighbours' median. The median is the member nearest to the medians of the components.
    Neighbours across a boundary are not asked. Reliability is the mean of the neighbours' times β.
    """

    name = "cohere_normals"
    assumptions = ("coherence", "local_spatial_interaction")

    def run(self, inputs: CohereNormalsInputs, ctx: Context) -> CohereNormalsOutputs:
        """Evidence of the images' size; it may speak where the cue itself did not, and its neighbours do."""
        ctx.check()
        evidence = _oriented(inputs)
        if not evidence.reliability.any():
            nobody = np.ones(inputs.depth.shape, np.float32)
            return CohereNormalsOutputs(evidence=evidence, beta=nobody, kappa=nobody)
        known = inputs.normals if inputs.normals is not None else np.full_like(evidence.value, np.nan)
        opinions = Opinions(evidence.value, evidence.value, known, evidence.reliability, evidence.sigma)
        verdict = validated(opinions, inputs.boundaries, NEIGHBOURS, self.params.rho)
        ctx.check()
        ctx.assumed("coherence", verdict.agreement >= 0.5)
        found = NormalsEvidence.of(verdict.value, verdict.sigma, verdict.trust)
        return CohereNormalsOutputs(evidence=found, beta=verdict.beta, kappa=verdict.kappa)


def _oriented(inputs: CohereNormalsInputs) -> NormalsEvidence:
    """What the cue says, as normals; with several forms, the first in the order of the ports."""
    if inputs.normals_evidence is not None:
        return inputs.normals_evidence
    if inputs.slopes_evidence is not None:
        return _from_slopes(inputs, inputs.slopes_evidence.value, inputs.slopes_evidence, np.float32(1))
    if inputs.relief_evidence is not None:
        relief = inputs.relief_evidence
        return _from_slopes(inputs, slopes_from_depth(relief.value), relief, DIFFERENCE)
    nothing = np.full((*inputs.depth.shape, 3), np.nan, np.float32)
    return NormalsEvidence.of(nothing, 1.0, 0.0)


def _from_slopes(
    inputs: CohereNormalsInputs, slopes: Array, evidence: Evidence, factor: np.float32
) -> NormalsEvidence:
    rows, columns = inputs.depth.shape
    camera = inputs.camera or Camera.uncalibrated(columns, rows)
    normals = normals_from_slopes(inputs.depth, slopes, camera)
    with np.errstate(divide="ignore", invalid="ignore"):
        sigma = factor * evidence.sigma * np.float32(camera.focal_length) / inputs.depth
    return NormalsEvidence.of(normals, np.minimum(sigma, np.float32(np.pi)), evidence.reliability)
