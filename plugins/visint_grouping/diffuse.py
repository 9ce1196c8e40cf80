"""``grouping.diffuse``: depth smoothed and filled in inside regions, never across a boundary."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence, Depth
from visint.fields import DepthEvidence
from visint.module import Context, Module, Params, Ports

__all__ = ["Diffuse"]

LEAST = 1e-4
"""Sigma is at least this part of depth: diffusion that changes nothing is not exact."""


class DiffuseParams(Params):
    """Parameters of ``grouping.diffuse``.

    Parameters
    ----------
    iterations
        Steps of diffusion. Noise is averaged, and unknown depth filled in, over about √iterations pixels of the
        level; more flattens curved surfaces.
    rate
        Part of the difference to the neighbours' mean that goes in a step; up to 1.
    filled
        Reliability of depth that was unknown.
    """

    iterations: int = Field(default=5, ge=1, le=10000)
    rate: float = Field(default=0.8, gt=0, le=1)
    filled: float = Field(default=0.3, ge=0, le=1)


class DiffuseInputs(Ports):
    """Depth, the barriers, and how sure the map is of depth; all known depth counts alike without."""

    depth: Depth[Array, "H W"]
    boundaries: Boundaries[Array, "H W"] | None = None
    depth_confidence: Confidence[Array, "H W"] | None = None


class DiffuseOutputs(Ports):
    """The diffused depth; sigma is the typical change that diffusion made."""

    depth: DepthEvidence


class Diffuse(Module[DiffuseParams, DiffuseInputs, DiffuseOutputs]):
    """Anisotropic diffusion of depth with boundaries as barriers (section 5.2.1; Grossberg's filling-in).

    Each step moves a pixel towards the mean of the two neighbours along each axis where both are known and on
    its own side, so planes stay planes up to their borders. Unknown pixels take the mean of known neighbours on
    their side. Boundary pixels themselves stay as they are, and nobody's neighbours.
    """

    name = "diffuse"
    assumptions = ("smoothness", "opacity")

    def run(self, inputs: DiffuseInputs, ctx: Context) -> DiffuseOutputs:
        """Diffused depth; unknown where a region knows nothing within reach."""
        from visint_grouping.lines import _kernels

        walls = inputs.boundaries if inputs.boundaries is not None else np.zeros(inputs.depth.shape, dtype=bool)
        before, after = inputs.depth.copy(), np.empty_like(inputs.depth)
        for _ in range(self.params.iterations):
            ctx.check()
            _kernels.diffuse(before, walls, np.float32(self.params.rate), after)
            before, after = after, before
        known = np.isfinite(inputs.depth)
        sure = inputs.depth_confidence
        trust = np.where(known, 1.0 if sure is None or not sure.any() else sure, self.params.filled)
        changed = np.abs(before - inputs.depth)[known]
        typical = 1.4826 * float(np.median(changed)) if changed.size else 0.0
        sigma = np.maximum(typical, LEAST * np.abs(np.nan_to_num(before)))
        return DiffuseOutputs(depth=DepthEvidence.of(before, sigma, trust))
