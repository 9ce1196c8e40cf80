"""``stereo.sgm``: dense disparity of a rectified pair by semi-global matching."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Disparity, Image, Mask
from visint.fields import Camera, DisparityEvidence
from visint.module import Context, Module, Params, Ports
from visint_stereo.semiglobal.brightness import graded
from visint_stereo.semiglobal.calming import calmed
from visint_stereo.semiglobal.match import Settings
from visint_stereo.semiglobal.reliability import TrainedOn
from visint_stereo.semiglobal.resolution import matched_within
from visint_stereo.semiglobal.search_range import estimated, within
from visint_stereo.semiglobal.volume import Levels, Penalties, Prior

__all__ = ["SemiGlobal"]


class SemiGlobalParams(Params):
    """Parameters of ``stereo.sgm``.

    Parameters
    ----------
    min_disparity, max_disparity
        Search range in full-size pixels; each overrides the camera's, and where neither is known the pair
        itself is asked. A wider range costs time and memory in proportion.
    small_jump, large_jump, even_jump
        Penalties in census bits (of 62) of a step by one level, of a larger jump across a strong brightness
        edge, and of one on an even surface. More gives smoother surfaces and loses thin things.
    outside
        Cost of a match outside the other image, in bits. The most sensitive of all: 18 is neutral.
    tolerance
        How far, in pixels of the level, the two views may disagree.
    speckle
        Islands of up to this many full-size pixels are not believed.
    trained_on
        Pairs the reliability was fitted on: ``all``, or half of them, to measure it fairly on the other half.
    """

    min_disparity: float | None = None
    max_disparity: float | None = None
    small_jump: int = Field(default=16, ge=1, le=40)
    large_jump: int = Field(default=24, ge=1, le=100)
    even_jump: int = Field(default=100, ge=1, le=100)
    outside: int = Field(default=18, ge=0, le=62)
    tolerance: float = Field(default=1.0, gt=0)
    speckle: int = Field(default=100, ge=0)
    trained_on: TrainedOn = "all"

    def settings(self, scale: int) -> Settings:
        """What the matching wants to know, at a level of this scale."""
        penalties = Penalties(self.small_jump, (self.large_jump, self.even_jump), outside=self.outside)
        return Settings(penalties, self.tolerance, self.speckle // scale**2, self.trained_on)


class SemiGlobalInputs(Ports):
    """A rectified pair; the camera gives the search range.

    ``prior``: a surface to follow, such as ``grouping.guide`` gives. Its reliability says how strongly: 0 not
    at all, 1 with up to 12 bits a pixel; along its slopes a step of up to 2 px costs nothing.
    """

    left: Image[Array, "H W"]
    right: Image[Array, "H W"]
    camera: Camera | None = None
    prior: DisparityEvidence | None = None


class SemiGlobalOutputs(Ports):
    """Disparity of the left view.

    ``consistent``: both views agree and the pixel is no speckle. ``occluded``: the left view alone sees it.
    Elsewhere the disparity is filled along the paths, with the low reliability that such values deserve.
    ``right_disparity``: of the right view, where the left pixel that it matches is consistent; NaN elsewhere.
    The two need not agree: it is for tests of visibility, which had better see too much than too little.
    """

    disparity: DisparityEvidence
    consistent: Mask[Array, "H W"]
    occluded: Mask[Array, "H W"]
    right_disparity: Disparity[Array, "H W"]


class SemiGlobal(Module[SemiGlobalParams, SemiGlobalInputs, SemiGlobalOutputs]):
    """Disparity of a rectified pair by semi-global matching of census transforms.

    H. Hirschmüller, Stereo processing by semiglobal matching and mutual information, PAMI 30(2), 2008,
    doi:10.1109/TPAMI.2007.1166; census: Zabih and Woodfill, ECCV 1994, doi:10.1007/BFb0028345. Eight paths,
    jumps cheaper across brightness edges, a neutral cost outside the other image (so the left border
    survives), agreement of both views, speckle removal, holes filled along the eight paths.

    Assumes a rectified pair; brightness may differ by any monotonic curve. Says nothing (NaN, reliability 0)
    where no texture lies within reach. Large pairs (above 40 million pixels times levels) are matched at half
    size first and then within 8 px of that.
    """

    name = "sgm"
    assumptions = ("opacity", "smoothness", "lambertian_reflectance", "rectified_views", "sufficient_context")

    def run(self, inputs: SemiGlobalInputs, ctx: Context) -> SemiGlobalOutputs:
        """Match the pair; arrays of the images' size, in pixels of the level."""
        left, right, blur = calmed(inputs.left, inputs.right)
        levels = self._levels(inputs.camera, left, right, ctx)
        ctx.measure("blur", blur)
        ctx.measure("first disparity", levels.first)
        ctx.measure("last disparity", levels.last)
        prior = None if inputs.prior is None else Prior.of(inputs.prior.value, inputs.prior.reliability)
        settings = self.params.settings(ctx.scale)
        match = matched_within(left, right, levels, settings, ctx.check, prior=prior)
        known = np.isfinite(inputs.left)
        return SemiGlobalOutputs(
            disparity=DisparityEvidence.of(match.disparity, match.sigma, known * match.trust),
            consistent=known & match.consistent,
            occluded=match.hidden,
            right_disparity=match.right,
        )

    def _levels(self, camera: Camera | None, left: Array, right: Array, ctx: Context) -> Levels:
        low, high = self.params.min_disparity, self.params.max_disparity
        given = camera.disparity_range if camera else None
        if given is None and (low is None or high is None):
            found = estimated(graded(left), graded(right))
            given = (float(found.first), float(found.last))
        first, last = given or (0.0, 0.0)
        return within(
            first if low is None else low / ctx.scale,
            last if high is None else high / ctx.scale,
            left.shape[1],
        )
