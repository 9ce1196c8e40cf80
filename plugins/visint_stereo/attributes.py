"""``stereo.attributes``: what the matcher by descent compares instead of bare intensity."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Features, Image
from visint.module import Context, Module, Params, Ports
from visint_stereo.descent.attribute_images import GRADES, attributes
from visint_stereo.noise import noise_of

__all__ = ["Attributes"]

USUAL_NOISE = 5.1
"""Noise, in grades, for which the matcher's smoothness is given: 2 % of full scale."""
LEAST_NOISE = 2.0
"""Views differ by more than their noise; below this many grades that is what counts."""


class AttributesParams(Params):
    """Parameters of ``stereo.attributes``.

    Parameters
    ----------
    blur
        Standard deviation of the smoothing, full-size pixels. 1.5 is better at 10 % noise, 1 at 2 %.
    noise_power
        How much noise counts: attributes are scaled by (5.1 / noise)^(power / 2), noise in 8-bit grades,
        which is the same as raising the matcher's smoothness with noise^power. 0 ignores noise.
    """

    blur: float = Field(default=1.0, gt=0, le=8)
    noise_power: float = Field(default=0.7, ge=0, le=2)


class AttributesInputs(Ports):
    """A rectified pair."""

    left: Image[Array, "H W"]
    right: Image[Array, "H W"]


class AttributesOutputs(Ports):
    """``images``: the attributes of the left and of the right view, (H, W, 4) each."""

    images: tuple[Features[Array, "H W 4"], ...]


class Attributes(Module[AttributesParams, AttributesInputs, AttributesOutputs]):
    """Smoothed intensity, gradient magnitude, positive and negative curvature of both views.

    The attributes of J. Weng, N. Ahuja and T. S. Huang, Matching two perspective views, PAMI 14(8), 1992,
    pp. 806-825, as functionals of order 0, 1 and 2 of the smoothed image. They depend on the images
    alone, so a graph computes them once; coarser levels read their means (dissertation, section 4.2, step A).
    """

    name = "attributes"
    assumptions = ("gaussian_noise",)

    def run(self, inputs: AttributesInputs, ctx: Context) -> AttributesOutputs:
        """The attributes, scaled by the noise of the pair (measured here, the same for both views)."""
        views = (inputs.left, inputs.right)
        noise = GRADES * float(np.mean([noise_of(view) for view in views]))
        ctx.measure("noise", noise)
        worth = (USUAL_NOISE / max(noise, LEAST_NOISE)) ** (self.params.noise_power / 2)
        blur = self.params.blur / ctx.scale
        return AttributesOutputs(images=tuple(attributes(view, blur) * np.float32(worth) for view in views))
