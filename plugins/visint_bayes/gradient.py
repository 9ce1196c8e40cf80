"""``bayes.gradient``: the consistency mapping of cues that know shape but not depth, Eq. 5.80."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence, Depth
from visint.fields import Camera, Evidence, NormalsEvidence, ReliefEvidence, SlopesEvidence, barriers
from visint.module import Context, Module, Params, Ports

__all__ = ["Gradient"]


class GradientParams(Params):
    """Parameters of ``bayes.gradient``.

    Parameters
    ----------
    alpha
        The coupling coefficient α = λ/(1 + λ), the amplitude of the cue: how much of its bend a step puts into
        the map. Published: at most 0.05. At 0 the neighbours' mean is taken wherever the cue bends the other
        way, and nothing of the cue's own: the control.
    """

    alpha: float = Field(default=0.05, ge=0, le=1)


class GradientInputs(Ports):
    """Validated evidence on shape, in one of three forms, and the map; without a camera 53° of view."""

    normals_evidence: NormalsEvidence | None = None
    relief_evidence: ReliefEvidence | None = None
    slopes_evidence: SlopesEvidence | None = None
    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    camera: Camera | None = None


class GradientOutputs(Ports):
    """The map's new depth, and how sure it is."""

    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"]


class Gradient(Module[GradientParams, GradientInputs, GradientOutputs]):
    """Depth bent the way a cue bends, where the two disagree in sign.

    Eq. 5.80, D = D̄ − α ΔD_sh, with the signed quarter-Laplacian ΔD_sh of the cue's surface (of normals and
    slopes: a quarter of the divergence), only where its sign differs from that of the map's own bend ΔD. The
    scale of what such cues say is not to be trusted, so α is small and nothing but the sign is tested. A step
    goes as far as the evidence is reliable: λ is per site. There is no data term; repeated without stereo the
    surface flattens.

    Confidence: the neighbours' mean, less what the step itself moved.
    """

    name = "gradient"
    assumptions = ("smoothness", "integrability")

    def run(self, inputs: GradientInputs, ctx: Context) -> GradientOutputs:
        """The map after this cue: one step."""
        from visint_bayes import _kernels

        ctx.check()
        depth, sure = inputs.depth, inputs.depth_confidence
        sure = np.zeros_like(depth) if sure is None else sure
        evidence = inputs.relief_evidence or inputs.slopes_evidence or inputs.normals_evidence
        if evidence is None or not evidence.reliability.any():
            return GradientOutputs(depth=depth, depth_confidence=sure)
        camera = inputs.camera or Camera.uncalibrated(depth.shape[1], depth.shape[0])
        reached = barriers.links_within(inputs.boundaries, depth)
        told = _bend(evidence, depth, camera, reached)
        after, confidence = np.empty_like(depth), np.empty_like(depth)
        numbers = (np.float32(self.params.alpha), np.float32(ctx.scale * camera.focal_length * camera.baseline))
        trust = evidence.reliability
        moved = _kernels.bend_down(depth, told, trust, sure, reached, *numbers, after, confidence)
        ctx.measure("against", moved / depth.size)
        return GradientOutputs(depth=after, depth_confidence=confidence)


def _bend(evidence: Evidence, depth: Array, camera: Camera, reached: Array) -> Array:
    """The quarter-Laplacian of the cue's surface; NaN where it is not known."""
    from visint_bayes import _kernels

    if isinstance(evidence, ReliefEvidence):
        return barriers.bend(evidence.value, reached)
    if isinstance(evidence, SlopesEvidence):
        return barriers.bend_of_slopes(evidence.value, reached)
    slopes = np.empty((*depth.shape, 2), np.float32)
    focal, cx, cy = (np.float32(each) for each in (camera.focal_length, camera.cx, camera.cy))
    _kernels.slopes_of(evidence.value, depth, focal, cx, cy, slopes)
    return barriers.bend_of_slopes(slopes, reached)
