"""``bayes.pairwise``: stereo's depth and shading's relief, two modules alone; Eq. 4.7."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, BoundaryKinds, Depth
from visint.arrays import Boundaries as Lines
from visint.fields import ReliefEvidence
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
        Where the neighbours' mean is taken: ``everywhere`` inside regions, or only where relief and depth bend
        ``against`` each other, as the correction always is.
    """

    alpha: float = Field(default=0.05, ge=0, le=1)
    smoothing: Literal["everywhere", "against"] = "everywhere"


class PairwiseInputs(Ports):
    """Depth of the matcher, relief of shading (None where it is not asked), and what holds them apart.

    Depth keeps its value on ``boundaries``, where stereo knows best; not where ``kinds`` says that the
    boundary is a limb or an occluding edge.
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

    def run(self, inputs: PairwiseInputs, ctx: Context) -> PairwiseOutputs:
        """One step from ``depth``."""
        walls = np.zeros(inputs.depth.shape, bool) if inputs.boundaries is None else inputs.boundaries
        bend = _bend(inputs.depth, walls)
        told = np.zeros_like(bend) if inputs.relief is None else _bend(inputs.relief.value, walls)
        against = told * bend < 0
        smooth = np.where(against, bend, 0) if self.params.smoothing == "against" else bend
        step = smooth - np.float32(self.params.alpha) * np.where(against, told, 0)
        held = walls if inputs.kinds is None else walls & ~np.isin(inputs.kinds, SEEN_BY_ONE_VIEW)
        ctx.check()
        return PairwiseOutputs(depth=inputs.depth + np.where(held, 0, step).astype(np.float32))


def _bend(field: Array, walls: Array) -> Array:
    """Mean of the four neighbours less the pixel, float32 (H, W); 0 where none is known on this side."""
    inner = np.pad(np.where(walls, np.float32(np.nan), field), 1, constant_values=np.nan)
    around = (inner[:-2, 1:-1], inner[2:, 1:-1], inner[1:-1, :-2], inner[1:-1, 2:])
    total, count = np.zeros_like(field), np.zeros_like(field)
    for neighbour in around:
        known = np.isfinite(neighbour)
        total += np.where(known, neighbour, 0)
        count += known
    bend = total / np.maximum(count, 1) - field
    return np.where((count > 0) & np.isfinite(bend), bend, 0).astype(np.float32)
