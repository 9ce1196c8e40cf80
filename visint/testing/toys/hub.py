"""Toy steps of a hub: coherence and consistency mapping, for one field each and for all evidence together."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array, Confidence, Depth
from visint.fields import Camera, DepthEvidence, DisparityEvidence
from visint.fields.geometry import depth_evidence
from visint.module import Context, Module, Params, Ports

__all__ = ["Blend", "BlendDisparity", "Cohere", "Joint"]


class CohereParams(Params):
    """``keep``: evidence less reliable than this is dropped."""

    keep: float = 0.5


class EvidencePorts(Ports):
    """Evidence on depth, before and after."""

    evidence: DepthEvidence


class Cohere(Module[CohereParams, EvidencePorts, EvidencePorts]):
    """Coherence of sorts: what is not reliable enough abstains."""

    name = "cohere"

    def run(self, inputs: EvidencePorts, ctx: Context) -> EvidencePorts:
        """The same evidence, with holes."""
        ctx.check()
        evidence = inputs.evidence
        trust = np.where(evidence.reliability < self.params.keep, np.float32(0), evidence.reliability)
        return EvidencePorts(evidence=DepthEvidence.of(evidence.value, evidence.sigma, trust))


class BlendParams(Params):
    """``alpha`` in [0, 1]: how far the map moves towards reliable evidence; 0 leaves it as it is."""

    alpha: float = 0.5


class BlendInputs(Ports):
    """The map's depth with its confidence, and evidence on it."""

    depth: Depth[Array, "H W"]
    evidence: DepthEvidence
    depth_confidence: Confidence[Array, "H W"] | None = None


class BlendOutputs(Ports):
    """The map's new depth and its confidence."""

    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"]


class Blend(Module[BlendParams, BlendInputs, BlendOutputs]):
    """Moves depth towards the evidence by ``alpha`` times its reliability; unknown depth takes it whole."""

    name = "blend"

    def run(self, inputs: BlendInputs, ctx: Context) -> BlendOutputs:
        """``Z + α r (E − Z)``; the confidence moves towards 1 in the same way."""
        ctx.check()
        return _blended(inputs.depth, inputs.evidence, inputs.depth_confidence, self.params.alpha)


class BlendDisparityInputs(Ports):
    """As for ``toy.blend``, with evidence on disparity and the camera that turns it into depth."""

    depth: Depth[Array, "H W"]
    evidence: DisparityEvidence
    camera: Camera
    depth_confidence: Confidence[Array, "H W"] | None = None


class BlendDisparity(Module[BlendParams, BlendDisparityInputs, BlendOutputs]):
    """``toy.blend`` for evidence on disparity."""

    name = "blend_disparity"

    def run(self, inputs: BlendDisparityInputs, ctx: Context) -> BlendOutputs:
        """As ``toy.blend``, after Z = fB/(d + doffs)."""
        ctx.check()
        evidence = depth_evidence(inputs.evidence, inputs.camera)
        return _blended(inputs.depth, evidence, inputs.depth_confidence, self.params.alpha)


class JointInputs(Ports):
    """The map's depth, and all evidence on it."""

    depth: Depth[Array, "H W"]
    evidence: tuple[DepthEvidence, ...]


class Joint(Module[Params, JointInputs, BlendOutputs]):
    """The mean of all evidence on depth, weighted by reliability/σ²; where all abstain depth stays."""

    name = "joint"

    def run(self, inputs: JointInputs, ctx: Context) -> BlendOutputs:
        """The confidence is the best reliability, 0 where all abstain."""
        ctx.check()
        total = np.zeros(inputs.depth.shape, np.float32)
        weights, trust = total.copy(), total.copy()
        for one in inputs.evidence:
            weight = np.where(one.reliability > 0, one.reliability / one.sigma**2, np.float32(0))
            total += np.where(weight > 0, one.value * weight, np.float32(0))
            weights += weight
            trust = np.maximum(trust, one.reliability)
        depth = np.where(weights > 0, total / np.where(weights > 0, weights, 1), inputs.depth)
        return BlendOutputs(depth=depth, depth_confidence=trust)


def _blended(depth: Array, evidence: DepthEvidence, confidence: Array | None, alpha: float) -> BlendOutputs:
    share = np.float32(alpha) * evidence.reliability
    moved = np.where(np.isnan(depth), evidence.value, depth + share * (evidence.value - depth))
    before = np.zeros(depth.shape, np.float32) if confidence is None else confidence
    return BlendOutputs(
        depth=np.where(evidence.reliability > 0, moved, depth),
        depth_confidence=before + share * (1 - before),
    )
