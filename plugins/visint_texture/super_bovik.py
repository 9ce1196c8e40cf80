"""``texture.super_bovik``: normals from how a texture's moments change."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence, Features, Normals, Regions
from visint.fields import Camera, NormalsEvidence
from visint.module import Context, Module, Params, Ports
from visint_texture.surface.answer import Answer
from visint_texture.surface.estimate import Estimate, Stiffness, as_plane, from_reference
from visint_texture.surface.known import Known
from visint_texture.surface.patches import Box, patches
from visint_texture.surface.reference import best_known
from visint_texture.surface.sites import Sites, laid_out

__all__ = ["SuperBovik"]


class SuperBovikParams(Params):
    """Parameters of ``texture.super_bovik``.

    Parameters
    ----------
    mode
        ``reference`` needs a site of known orientation in each region and abstains elsewhere; ``plane`` takes
        each region for one plane and needs none; ``auto`` takes the reference where there is one.
    trusted
        From which confidence of the map on a site may be a reference.
    cell
        Spacing of the sites, full-size pixels. Finer follows a bend closer, and is slower.
    bend
        How much a surface may bend from site to site. Less is smoother and flatter.
    rounds
        Rounds of Gauss-Newton; four are enough from a start within about 30°.
    regions
        How many regions at most, the largest first.
    """

    mode: Literal["auto", "reference", "plane"] = "auto"
    trusted: float = Field(default=0.3, gt=0, le=1)
    cell: float = Field(default=16.0, gt=0)
    bend: float = Field(default=2.0, gt=0)
    rounds: int = Field(default=4, ge=1, le=20)
    regions: int = Field(default=8, ge=1)


class SuperBovikInputs(Ports):
    """Moments, and what is known already.

    ``moments`` as of ``texture.moments`` (zero: no texture), ``texture`` how much of one there is; ``regions``
    that each hold one texture (the map's, or those of ``texture.regions``); ``normals`` and
    ``depth_confidence`` of the map, from which the reference is taken; without a ``camera`` 53° of view.
    """

    moments: Features[Array, "H W 3"]
    texture: Confidence[Array, "H W"] | None = None
    regions: Regions[Array, "H W"] | None = None
    normals: Normals[Array, "H W 3"] | None = None
    depth_confidence: Confidence[Array, "H W"] | None = None
    camera: Camera | None = None


class SuperBovikOutputs(Ports):
    """Normals, and how ambiguous their tilt was before the map's normals decided: 1 where nothing did."""

    normals: NormalsEvidence
    ambiguity: Confidence[Array, "H W"]


class SuperBovik(Module[SuperBovikParams, SuperBovikInputs, SuperBovikOutputs]):
    """Normals from the moments of a homogeneous texture and one site of known orientation.

    B. J. Super and A. C. Bovik, Shape from texture using local spectral moments, PAMI 17(4), 1995.
    Eqs. 5.85 to 5.93 of section 5.2.4 in their corrected reading. In each region
    the reference is where map and texture are surest; slant and four candidate tilts follow at each site
    about its own ray, the map's normals choose, and one smooth perspective surface is fitted to all moments.
    Without a reference a region is one plane, found from its density gradient and then from all moments.

    Assumes one homogeneous texture in a region. Stripes, noise, shading and mixtures get low reliability or
    none; so does what lies more than a window beyond the texture.
    """

    name = "super_bovik"
    assumptions = (
        "homogeneity",
        "smoothness",
        "sufficient_context",
        "regular_projective_geometry",
        "perfect_segmentation",
    )

    def run(self, inputs: SuperBovikInputs, ctx: Context) -> SuperBovikOutputs:
        """Normals of the moments' size."""
        rows, columns = inputs.moments.shape[:2]
        texture = inputs.texture
        if texture is None:
            texture = (inputs.moments[..., 0] + inputs.moments[..., 2] > 0).astype(np.float32)
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        sites = laid_out(inputs.moments, texture, camera, max(1, round(self.params.cell / ctx.scale)))
        ctx.check()
        known = Known.of(inputs.normals, inputs.depth_confidence, sites.shape)
        answer = Answer.empty(sites.shape)
        for box, inside in patches(sites, inputs.regions, self.params.regions):
            ctx.check()
            part = sites.within(box, inside)
            estimate = self._estimate(part, known, box)
            if estimate is not None:
                answer.take(part, estimate, box, inside)
        ctx.measure("mean reliability", float(answer.reliability.mean()))
        for name in ("homogeneity", "sufficient_context"):
            ctx.assumed(name, *answer.found(name, (rows, columns)))
        normals, ambiguity = answer.over((rows, columns), texture)
        return SuperBovikOutputs(normals=normals, ambiguity=ambiguity)

    def _estimate(self, sites: Sites, known: Known, box: Box) -> Estimate | None:
        normals, confidence = known.normals[box], known.confidence[box]
        place = best_known(sites, normals, np.where(confidence >= self.params.trusted, confidence, 0))
        if self.params.mode != "plane" and place is not None:
            stiffness = Stiffness(self.params.bend, self.params.rounds)
            return from_reference(sites, place, normals[place], normals, stiffness)
        return None if self.params.mode == "reference" else as_plane(sites)
