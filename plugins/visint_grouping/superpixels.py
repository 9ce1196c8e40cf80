"""``grouping.superpixels``: regions of like colour, small enough that one plane may pass for each."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Color, Image, Regions
from visint.module import Context, Module, Params, Ports
from visint_grouping.partition import numbered

__all__ = ["Superpixels", "SuperpixelsParams", "graded_colour", "superpixels_in"]

ROUNDING = 0.8
"""Standard deviation of the smoothing before colours are compared, px."""


class SuperpixelsParams(Params):
    """Parameters of ``grouping.superpixels``.

    Parameters
    ----------
    breadth
        How much a region may vary inside before it is cut: its size in pixels times the steps, in grey levels
        of 255, that a region of that size may have. More gives larger regions, which cross depth edges.
    smallest
        Pixels that a region has at least, full-size. More leaves fewer regions with too little to fit a plane
        to.
    """

    breadth: float = Field(default=150.0, gt=0)
    smallest: int = Field(default=80, ge=1)


class SuperpixelsInputs(Ports):
    """One view, with its colour where there is any."""

    image: Image[Array, "H W"]
    color: Color[Array, "H W 3"] | None = None


class SuperpixelsOutputs(Ports):
    """``regions``: labels from 1; every pixel has one."""

    regions: Regions[Array, "H W"]


class Superpixels(Module[SuperpixelsParams, SuperpixelsInputs, SuperpixelsOutputs]):
    """Regions of like colour: pixels merge along their smallest steps while a region's own variety allows it.

    P. Felzenszwalb and D. Huttenlocher, Efficient graph-based image segmentation, IJCV 59(2), 2004,
    doi:10.1023/B:VISI.0000022288.19776.77. Unlike ``grouping.split_merge`` it follows a shade across a surface
    and leaves no pixel out; unlike ``grouping.perceptual`` it makes no promise that an outline means anything.
    Linear in pixels. Pixels of unknown intensity count as black.
    """

    name = "superpixels"
    assumptions = ("cohesiveness",)

    def run(self, inputs: SuperpixelsInputs, ctx: Context) -> SuperpixelsOutputs:
        """Regions at this level."""
        labels = superpixels_in(graded_colour(inputs.image, inputs.color), self.params, ctx.scale)
        ctx.check()
        ctx.measure("regions", int(labels.max(initial=-1)) + 1)
        return SuperpixelsOutputs(regions=labels + np.int32(1))


def graded_colour(image: Array, color: Array | None) -> Array:
    """float32 (H, W, C) in 0..255, by the curve of 8-bit files: what the eye takes for even steps."""
    linear = image[..., None] if color is None else color
    known = np.clip(np.nan_to_num(linear, nan=0.0, posinf=1.0, neginf=0.0), 0, 1)
    curve = np.where(known <= 0.0031308, 12.92 * known, 1.055 * known ** (1 / 2.4) - 0.055)
    return np.asarray(255 * curve, dtype=np.float32)


def superpixels_in(levels: Array, params: SuperpixelsParams, scale: int = 1) -> Array:
    """int32 (H, W) from 0: regions of ``levels``, float32 (H, W, C) in 0..255."""
    import cv2

    from visint_grouping.planes import _kernels

    smooth = cv2.GaussianBlur(levels, (0, 0), ROUNDING, borderType=cv2.BORDER_REFLECT_101)
    home = np.empty(levels.shape[0] * levels.shape[1], np.int32)
    smallest = max(1, params.smallest // scale**2)
    _kernels.superpixels(smooth.reshape(levels.shape), np.float32(params.breadth), smallest, home)
    return numbered(home.reshape(levels.shape[:2]))[0]
