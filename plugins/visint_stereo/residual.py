"""``stereo.residual``: what the images still say against a surface, pixel by pixel."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Disparity, Features
from visint.fields import DisparityEvidence
from visint.module import Context, Module, Params, Ports
from visint_stereo.descent.start import complete, right_from_left

__all__ = ["Residual"]


class ResidualParams(Params):
    """Parameters of ``stereo.residual``.

    Parameters
    ----------
    weights
        Of smoothed intensity, gradient magnitude, positive and negative curvature. Intensity alone by default:
        on shaded surfaces the others depend on the viewpoint.
    reach
        Corrections beyond this many pixels of the level are not believed: the residual is linear only nearby.
    """

    weights: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    reach: float = Field(default=2.0, gt=0)


class ResidualInputs(Ports):
    """Attributes of both views and the disparity of the current surface, all of one level."""

    attributes: tuple[Features[Array, "H W 4"], ...]
    disparity: Disparity[Array, "H W"]


class ResidualOutputs(Ports):
    """The corrected disparity, unsmoothed: each pixel speaks for itself."""

    disparity: DisparityEvidence


class Residual(Module[ResidualParams, ResidualInputs, ResidualOutputs]):
    """The unsmoothed correction d - r/J of a surface by the images, with sigma σ/|J|.

    Several attributes count together: d - Σ w J R / Σ w J², sigma σ/√(Σ w J²). σ is the robust spread of the
    residual over the whole image, so a surface far off makes everything uncertain. The data term that a joint
    estimate wants: it carries no smoothing of a matcher (Eq. 5.100 to 5.102).

    Silent where the surface is hidden from the right view or leaves it, where J is 0, and beyond ``reach``.
    """

    name = "residual"
    assumptions = ("opacity", "brightness_constancy", "rectified_views", "sufficient_context")

    def run(self, inputs: ResidualInputs, ctx: Context) -> ResidualOutputs:
        """One linearisation; no loop, no memory."""
        from visint_stereo.descent import _kernels

        if len(inputs.attributes) != 2:
            raise ValueError(f"attributes wants two images, left and right; got {len(inputs.attributes)}")
        left, right = inputs.attributes
        field = inputs.disparity
        slope, strength, error = (np.empty_like(field) for _ in range(3))
        weights = np.asarray(self.params.weights, dtype=np.float32)
        _kernels.compare(left, right, weights, np.float32(-1), field, slope, strength, error)
        ctx.check()
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -slope / strength
            sigma = _spread(error) / np.sqrt(strength)
        trust = _seen(field) * np.maximum(0, 1 - (step / self.params.reach) ** 2)
        return ResidualOutputs(disparity=DisparityEvidence.of(field + step, sigma, trust))


def _spread(error: Array) -> float:
    """Robust standard deviation of the residual whose weighted squares are ``error`` (H, W)."""
    known = error[np.isfinite(error)]
    return 1.4826 * float(np.sqrt(np.median(known))) + 0.05 if known.size else 1.0


def _seen(field: Array) -> Array:
    """float32 (H, W): 1 where nothing nearer hides the surface from the right view, 0 from 1.5 px nearer."""
    from visint_stereo.descent import _kernels

    found = np.empty_like(field)
    _kernels.follow(right_from_left(complete(field)), field, np.float32(-1), found)
    return np.asarray(np.nan_to_num(np.clip(1.5 - np.maximum(found - field, 0), 0, 1)))
