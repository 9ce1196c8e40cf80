"""``stereo.weng``: the matcher of Weng, Ahuja and Huang, one update (or a few) of both disparity fields."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Disparity, Features
from visint.fields import DisparityEvidence
from visint.module import Context, Module, Params, Ports
from visint_stereo.descent.judgement import judged
from visint_stereo.descent.reliability import evidence_of, tested
from visint_stereo.descent.sides import one_side, seen_in_the_other_view, sides_of
from visint_stereo.descent.start import complete, left_from_right, right_from_left, shift_between

__all__ = ["Weng"]

HELD_IN_FIRST = np.array([False, True, False])
"""A premise held in region 1, and not in region 2."""


class WengParams(Params):
    """Parameters of ``stereo.weng``.

    Parameters
    ----------
    smoothness
        λ: more gives smoother fields and slower convergence. Calibrated for 2 % noise; ``stereo.attributes``
        scales its images so that it need not change with the noise.
    weights
        Of smoothed intensity, gradient magnitude, positive and negative curvature. The last three see detail,
        but have kinks (0.1 px) and, on shaded surfaces without texture, depend on the viewpoint (some pixels).
    across
        Weight of a neighbour across a boundary, of 1 inside a region.
    iterations
        Updates a call. A loop of the graph does the same, one turn at a time.
    reach
        An update goes no further than this many pixels of the level from its neighbours' mean.
    """

    smoothness: float = Field(default=100.0, gt=0)
    weights: tuple[float, float, float, float] = (1.0, 0.1, 0.05, 0.05)
    across: float = Field(default=0.05, ge=0, le=1)
    iterations: int = Field(default=1, ge=1)
    reach: float = Field(default=0.75, gt=0)


class WengInputs(Ports):
    """Attributes of both views at this level, and what is known so far.

    ``disparity`` and ``right_disparity`` are the fields of the turn before. Without the right one, what the
    left one implies is taken; without both, the best common shift. ``boundaries`` hold smoothness back.
    """

    attributes: tuple[Features[Array, "H W 4"], ...]
    disparity: Disparity[Array, "H W"] | None = None
    right_disparity: Disparity[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None


class WengOutputs(Ports):
    """Both fields, everywhere known, and the left one as evidence."""

    left: Disparity[Array, "H W"]
    right: Disparity[Array, "H W"]
    disparity: DisparityEvidence


class Weng(Module[WengParams, WengInputs, WengOutputs]):
    """Both disparity fields one step closer to agreement of four attributes, smooth inside regions.

    J. Weng, N. Ahuja and T. S. Huang, Matching two perspective views, PAMI 14(8), 1992, pp. 806-825; Eq. 3.1
    of the dissertation, solved by Gauss-Newton around the neighbours' mean:
    d = d̄ - Σ w J R(d̄) / (λ + Σ w J²). Wants a loop over a pyramid: a step sees about a pixel of its level.

    Assumes a rectified pair of matte surfaces. Excels on smooth shaded objects; blurs depth edges that no
    boundary marks, and loses thin things. Reliability: precision J'J/σ² (Eq. 5.102), agreement of the two
    fields, residual; pixels without texture around them, or matched outside the other image, get none.
    """

    name = "weng"
    version = "2"
    assumptions = (
        "opacity",
        "smoothness",
        "lambertian_reflectance",
        "brightness_constancy",
        "rectified_views",
        "sufficient_context",
    )

    def run(self, inputs: WengInputs, ctx: Context) -> WengOutputs:
        """Update both fields ``iterations`` times."""
        if len(inputs.attributes) != 2:
            raise ValueError(f"attributes wants two images, left and right; got {len(inputs.attributes)}")
        left, right = inputs.attributes
        fields = self._start(inputs)
        sides = _sides(inputs.boundaries, left[..., 0], fields[1])
        for _ in range(self.params.iterations):
            fields = (
                self._sweep(left, right, sides[0], -1, fields[0]),
                self._sweep(right, left, sides[1], +1, fields[1]),
            )
            ctx.check()
        judgement = judged(left, right, self._weights, fields)
        for premise, holds in tested(judgement).items():
            ctx.assumed(premise, HELD_IN_FIRST, np.where(holds, np.int32(1), np.int32(2)))
        return WengOutputs(left=fields[0], right=fields[1], disparity=evidence_of(fields[0], judgement))

    @property
    def _weights(self) -> Array:
        return np.asarray(self.params.weights, dtype=np.float32)

    def _sweep(self, here: Array, there: Array, sides: Array, sign: int, field: Array) -> Array:
        from visint_stereo.descent import _kernels

        numbers = (np.float32(n) for n in (self.params.smoothness, self.params.reach, self.params.across, sign))
        smoothness, reach, across, way = numbers
        after = np.empty_like(field)
        _kernels.sweep(here, there, self._weights, smoothness, reach, sides, across, way, field, after)
        return after

    def _start(self, inputs: WengInputs) -> tuple[Array, Array]:
        left, right = inputs.disparity, inputs.right_disparity
        if left is None and right is None:
            here, there = (np.ascontiguousarray(view[..., 0]) for view in inputs.attributes)
            shift = np.full(here.shape, shift_between(here, there), dtype=np.float32)
            return shift, shift
        if left is None:
            assert right is not None
            left = left_from_right(complete(right))
        left = complete(left)
        return left, right_from_left(left) if right is None else complete(right)


def _sides(boundaries: Array | None, brightness: Array, right: Array) -> tuple[Array, Array]:
    """The sides of either view: of the left by its ``boundaries``, of the right as its field carries them."""
    if boundaries is None or not boundaries.any():
        none = one_side(brightness.shape)
        return none, none
    sides = sides_of(boundaries, np.ascontiguousarray(brightness))
    return sides, seen_in_the_other_view(sides, right)
