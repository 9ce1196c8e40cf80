"""``texture.moments``: second moments of the local spectrum, and where there is texture."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence, Features, Image
from visint.module import Context, Module, Params, Ports
from visint_texture.spectrum.bank import Bank
from visint_texture.spectrum.contrast import contrast
from visint_texture.spectrum.gabor import Weighing, gabor_moments
from visint_texture.spectrum.local import LocalMoments
from visint_texture.spectrum.tensor import tensor_moments

__all__ = ["Moments"]

HIGHEST = 0.48
"""The highest ring, cycles a pixel: just below what an image can hold."""
SMALLEST_WINDOW = 6.0
"""A spectrum needs some pixels of its own level, however coarse."""


class MomentsParams(Params):
    """Parameters of ``texture.moments``.

    Parameters
    ----------
    method
        ``gabor``: a bank of filters; ``tensor``: the structure tensor, fifteen times faster, right for smooth
        textures and too sure of the image's blur where edges are sharp.
    window
        Spread of the Gaussian window, full-size pixels. Wider is steadier, and blurs where a surface bends.
    longest
        Wavelength of the bank's lowest ring, full-size pixels; slower changes are taken for shading.
    rings, orientations
        Filters of the bank. Fewer are faster; below 5 and 4 the moments feel the gaps between them.
    power
        Filters count by energy to this power. 1 is the plain moment, which the blur of sharp edges rules;
        more lets the dominant band speak.
    blur
        Of the structure tensor's image, pixels of the level.
    """

    method: Literal["gabor", "tensor"] = "gabor"
    window: float = Field(default=24.0, gt=0)
    longest: float = Field(default=40.0, gt=0)
    rings: int = Field(default=7, ge=2, le=16)
    orientations: int = Field(default=6, ge=3, le=16)
    power: float = Field(default=2.0, ge=1, le=4)
    blur: float = Field(default=1.0, ge=0.5)


class MomentsInputs(Ports):
    """One linear image."""

    image: Image[Array, "H W"]


class MomentsOutputs(Ports):
    """What the local spectrum says.

    ``moments``: (g_x, 2E[u_x u_y], g_y) in (cycles per pixel of the level)², x along columns and y along rows;
    zero where there is no texture. ``texture``: how much of a texture there is, 0 to 1.
    """

    moments: Features[Array, "H W 3"]
    texture: Confidence[Array, "H W"]


class Moments(Module[MomentsParams, MomentsInputs, MomentsOutputs]):
    """Second moments of the local spectrum: how fine a texture is, and along which direction.

    B. J. Super and A. C. Bovik, Shape from texture using local spectral moments, PAMI 17(4), 1995.
    Gabor filters and their derivatives, filtered in the plane of frequencies; or the
    structure tensor (Bigün and Granlund 1987). The image is divided by its local mean first.

    Assumes that nothing but albedo changes within a window. Depends on the image alone: keep it out of
    sweeps. Where the window is smaller than six pixels of the level, six are taken.
    """

    name = "moments"
    assumptions = ("local_spatial_interaction", "sufficient_context")

    def run(self, inputs: MomentsInputs, ctx: Context) -> MomentsOutputs:
        """Moments of the image's size."""
        import cv2

        window = max(self.params.window / ctx.scale, SMALLEST_WINDOW)
        local, longest = self._local(contrast(inputs.image, window), window, ctx)
        ctx.check()
        texture = local.texture(longest)
        size = inputs.image.shape[::-1]
        texture = cv2.resize(texture, size, interpolation=cv2.INTER_LINEAR)
        moments = cv2.resize(local.moments, size, interpolation=cv2.INTER_LINEAR)
        known = np.isfinite(inputs.image) & (texture > 0)
        texture = np.where(known, texture, 0).astype(np.float32, copy=False)
        ctx.measure("textured", float((texture > 0.5).mean()))
        return MomentsOutputs(moments=moments * known[..., None], texture=texture)

    def _local(self, image: Array, window: float, ctx: Context) -> tuple[LocalMoments, float]:
        """The moments on a lattice of a sixth of the window, and the longest wave that was asked for, px."""
        params, step = self.params, max(1, int(window / 6))
        longest = max(params.longest / ctx.scale, SMALLEST_WINDOW)
        if params.method == "tensor":
            return tensor_moments(image, window, params.blur, step), longest
        bank = Bank(1 / longest, HIGHEST, params.rings, params.orientations)
        return gabor_moments(image, bank, window, step, Weighing(params.power), ctx.check), longest
