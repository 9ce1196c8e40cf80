"""``stereo.sgm``: dense disparity of a rectified pair by semi-global matching."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Image, Mask
from visint.fields import Camera, DisparityEvidence
from visint.module import Context, Module, Params, Ports
from visint_stereo.semiglobal.brightness import graded
from visint_stereo.semiglobal.calming import calmed
from visint_stereo.semiglobal.consistency import agreed, occluded, without_speckles
from visint_stereo.semiglobal.fill import from_behind
from visint_stereo.semiglobal.refine import refined
from visint_stereo.semiglobal.reliability import TrainedOn, contrast, reliability, signs
from visint_stereo.semiglobal.search_range import estimated, within
from visint_stereo.semiglobal.volume import Levels, Penalties, Volume, census, matching_costs, path_costs
from visint_stereo.semiglobal.winner import winners

__all__ = ["SemiGlobal"]


FILLED = 4.0
"""Sigma of a disparity filled from its neighbours, px."""


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

    def penalties(self) -> Penalties:
        """The penalties as the volume wants them."""
        return Penalties(self.small_jump, (self.large_jump, self.even_jump), outside=self.outside)


class SemiGlobalInputs(Ports):
    """A rectified pair; the camera gives the search range."""

    left: Image[Array, "H W"]
    right: Image[Array, "H W"]
    camera: Camera | None = None


class SemiGlobalOutputs(Ports):
    """Disparity of the left view.

    ``consistent``: both views agree and the pixel is no speckle. ``occluded``: the left view alone sees it.
    Elsewhere the disparity is filled from behind, with the low reliability that such values deserve.
    """

    disparity: DisparityEvidence
    consistent: Mask[Array, "H W"]
    occluded: Mask[Array, "H W"]


class SemiGlobal(Module[SemiGlobalParams, SemiGlobalInputs, SemiGlobalOutputs]):
    """Disparity of a rectified pair by semi-global matching of census transforms.

    H. Hirschmüller, Stereo processing by semiglobal matching and mutual information, PAMI 30(2), 2008,
    doi:10.1109/TPAMI.2007.1166; census: Zabih and Woodfill, ECCV 1994, doi:10.1007/BFb0028345. Eight paths,
    jumps cheaper across brightness edges, a neutral cost outside the other image (so the left border
    survives), agreement of both views, speckle removal, holes filled from behind.

    Assumes a rectified pair; brightness may differ by any monotonic curve. Says nothing (NaN, reliability 0)
    where no texture lies within reach.
    """

    name = "sgm"

    def run(self, inputs: SemiGlobalInputs, ctx: Context) -> SemiGlobalOutputs:
        """Match the pair; arrays of the images' size, in pixels of the level."""
        here, there, blur = calmed(inputs.left, inputs.right)
        ctx.measure("blur", blur)
        left, right = graded(here), graded(there)
        levels = self._levels(inputs.camera, left, right, ctx)
        ctx.measure("first disparity", levels.first)
        ctx.measure("last disparity", levels.last)
        won = winners(self._volume(left, right, levels, ctx))
        ctx.check()
        seen = np.isfinite(inputs.left) & (contrast(left) > 0)
        trusted = seen & agreed(won.disparity, won.right, self.params.tolerance)
        trusted = without_speckles(won.disparity, trusted, self.params.speckle // ctx.scale**2)
        views = (left.astype(np.float32) / 16, right.astype(np.float32) / 16)
        fine, sigma = refined(won.disparity, trusted, views, levels)
        disparity = from_behind(fine, trusted)
        trust = reliability(signs(left, won, trusted, np.nan_to_num(disparity)), self.params.trained_on)
        return SemiGlobalOutputs(
            disparity=DisparityEvidence.of(disparity, np.where(trusted, sigma, FILLED), seen * trust),
            consistent=trusted,
            occluded=occluded(won.disparity, won.right, trusted),
        )

    def _levels(self, camera: Camera | None, left: Array, right: Array, ctx: Context) -> Levels:
        low, high = self.params.min_disparity, self.params.max_disparity
        given = camera.disparity_range if camera else None
        if given is None and (low is None or high is None):
            found = estimated(left, right)
            given = (float(found.first), float(found.last))
        first, last = given or (0.0, 0.0)
        return within(
            first if low is None else low / ctx.scale,
            last if high is None else high / ctx.scale,
            left.shape[1],
        )

    def _volume(self, left: Array, right: Array, levels: Levels, ctx: Context) -> Volume:
        penalties = self.params.penalties()
        cost = matching_costs(census(left), census(right), levels, penalties.outside)
        ctx.check()
        return Volume(levels, path_costs(cost, left, penalties, ctx.check))
