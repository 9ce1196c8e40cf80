"""``bayes.pairwise``: stereo's depth and shading's relief, two modules alone; Eq. 4.7."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, BoundaryKinds, Depth
from visint.arrays import Boundaries as Lines
from visint.fields import ReliefEvidence, barriers
from visint.module import Context, Module, Params, Ports

__all__ = ["Pairwise"]

SEEN_BY_ONE_VIEW = (1, 2)
"""Limbs and occluding edges: the surface turns away or ends there, and stereo is at its worst."""


class PairwiseParams(Params):
    """Parameters of ``bayes.pairwise``.

    Parameters
    ----------
    alpha
        The coupling coefficient α = λ/(1+λ): how much of the relief's bending a sweep puts into the depth. 0 is
        the control: the neighbours' mean alone. Above 0.05 the relief's own errors show.
    smoothing
        Where the neighbours' mean is taken: only where relief and depth bend ``against`` each other, as Eq. 4.7
        is said to apply, or ``everywhere`` inside regions, which smooths more and flattens.
    """

    alpha: float = Field(default=0.05, ge=0, le=1)
    smoothing: Literal["everywhere", "against"] = "against"


class PairwiseInputs(Ports):
    """Depth of the matcher, relief of shading, and what holds them apart.

    Without relief, on levels where shading is not asked, there is no step. Depth keeps its value on
    ``boundaries``, where stereo knows best; where ``kinds`` says that the boundary is a limb or an occluding
    edge it takes the mean of its own side.
    """

    depth: Depth[Array, "H W"]
    relief: ReliefEvidence | None = None
    boundaries: Lines[Array, "H W"] | None = None
    kinds: BoundaryKinds[Array, "H W"] | None = None


class PairwiseOutputs(Ports):
    """The corrected depth, known wherever the matcher's was."""

    depth: Depth[Array, "H W"]


class Pairwise(Module[PairwiseParams, PairwiseInputs, PairwiseOutputs]):
    """Depth drawn to its neighbours' mean, and bent as shading says: D̄ − α ΔD_sh, Eq. 4.7 with 4.8 and 4.9.

    One Jacobi step of minimising membrane energy plus λ times the difference of slopes; ΔD is the mean of the
    four neighbours less the pixel. The correction is made where the two bend in opposite ways, since the scale
    of the relief is not to be trusted. There is no data term: repeated without stereo's answer it flattens the
    surface, so it belongs into a loop with the matcher. Neighbours beyond a boundary do not count.
    """

    name = "pairwise"
    assumptions = ("smoothness", "lambertian_reflectance")

    def run(self, inputs: PairwiseInputs, ctx: Context) -> PairwiseOutputs:
        """One step from ``depth``."""
        if inputs.relief is None:
            return PairwiseOutputs(depth=inputs.depth)
        reached = barriers.links_within(inputs.boundaries, inputs.depth)
        depth, held = _on_boundaries(inputs, reached)
        own = barriers.bend(depth, reached)
        told = np.nan_to_num(barriers.bend(inputs.relief.value, reached))
        against = told * own < 0
        smooth = np.where(against, own, 0) if self.params.smoothing == "against" else own
        step = np.nan_to_num(smooth - np.float32(self.params.alpha) * np.where(against, told, 0))
        ctx.check()
        ctx.measure("against", float(against.mean()))
        return PairwiseOutputs(depth=depth + np.where(held, np.float32(0), step))


def _on_boundaries(inputs: PairwiseInputs, reached: Array) -> tuple[Array, Array]:
    """Depth to start from, limbs and occluding edges with their own side's; where it is held, bool (H, W)."""
    depth, lines, kinds = inputs.depth, inputs.boundaries, inputs.kinds
    if lines is None:
        return depth, np.zeros(depth.shape, bool)
    if kinds is None:
        return depth, lines
    beside, count = barriers.mean(np.where(lines, np.float32(np.nan), depth), reached)
    loose = lines & np.isin(kinds, SEEN_BY_ONE_VIEW) & (count > 0)
    return np.where(loose, beside, depth), lines & ~loose
