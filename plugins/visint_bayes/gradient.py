"""``bayes.gradient``: the consistency mapping of cues that know shape but not depth, Eq. 5.80."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence, Depth
from visint.fields import Camera, Evidence, NormalsEvidence, ReliefEvidence, SlopesEvidence, barriers
from visint.fields.geometry import slopes_from_normals
from visint.module import Context, Module, Params, Ports
from visint_bayes.sureness import confidence_of, depth_per_pixel, variance_of

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
        ctx.check()
        reached = barriers.links_within(inputs.boundaries, inputs.depth)
        told, trust = _told(inputs, reached)
        bend = barriers.bend(inputs.depth, reached)
        against = (told * bend < 0) & np.isfinite(inputs.depth)
        step = np.where(against, trust * (bend - np.float32(self.params.alpha) * told), np.float32(0))
        ctx.measure("against", float(against.mean()))
        sure = _confidence(inputs, step, reached, ctx.scale)
        return GradientOutputs(depth=inputs.depth + step, depth_confidence=sure)


def _told(inputs: GradientInputs, reached: Array) -> tuple[Array, Array]:
    """(the cue's bend, its reliability); no bend where it says nothing."""
    rows, columns = inputs.depth.shape
    evidence: Evidence | None = None
    bend = np.zeros(inputs.depth.shape, np.float32)
    if inputs.relief_evidence is not None:
        evidence = inputs.relief_evidence
        bend = barriers.bend(evidence.value, reached)
    elif inputs.slopes_evidence is not None:
        evidence = inputs.slopes_evidence
        bend = barriers.bend_of_slopes(evidence.value, reached)
    elif inputs.normals_evidence is not None:
        evidence = inputs.normals_evidence
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        bend = barriers.bend_of_slopes(slopes_from_normals(inputs.depth, evidence.value, camera), reached)
    trust = bend if evidence is None else evidence.reliability
    return np.nan_to_num(bend, nan=0.0), trust


def _confidence(inputs: GradientInputs, step: Array, reached: Array, scale: int) -> Array:
    """What the step moved counts as doubt; where nothing moved, all stays."""
    rows, columns = inputs.depth.shape
    before = inputs.depth_confidence
    if before is None:
        return np.zeros((rows, columns), np.float32)
    camera = inputs.camera or Camera.uncalibrated(columns, rows)
    with np.errstate(divide="ignore", invalid="ignore"):
        moved = np.float32(scale) * step / depth_per_pixel(inputs.depth, camera)
    around, count = barriers.mean(before, reached)
    mixed = np.where(count > 0, around, before)
    with np.errstate(over="ignore"):
        doubted = confidence_of(variance_of(mixed) + moved * moved)
    return np.where(step != 0, doubted, before)
