"""``grouping.canny``: the edges of an image."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Image
from visint.module import Context, Module, Params, Ports
from visint_grouping.brightness import Brightness, graded

__all__ = ["Canny", "CannyParams", "edges_in"]

UNITS = 8
"""Sobel's mask answers a ramp of one grey level a pixel with 8; so much finer are the rounded gradients."""


class CannyParams(Params):
    """Parameters of ``grouping.canny``.

    Parameters
    ----------
    blur
        Standard deviation of the smoothing before the gradient, full-size pixels. More hears less noise and
        rounds corners.
    low, high
        Thresholds of hysteresis, in the units of OpenCV's Canny on 8-bit images: a sharp step of one grey
        level gives 3.2 / blur. An edge needs ``high`` somewhere and ``low`` all along.
    noise
        The thresholds are at least 0.6 and 1 times this many standard deviations of the image's noise (grey
        levels, measured). 0 keeps them fixed.
    """

    blur: float = Field(default=1.4, gt=0, le=16)
    low: float = Field(default=20.0, ge=0)
    high: float = Field(default=60.0, ge=0)
    noise: float = Field(default=4.0, ge=0)


class CannyInputs(Ports):
    """One view."""

    image: Image[Array, "H W"]


class CannyOutputs(Ports):
    """``boundaries``: edges, one pixel wide, most of them open."""

    boundaries: Boundaries[Array, "H W"]


class Canny(Module[CannyParams, CannyInputs, CannyOutputs]):
    """Edges: maxima of the smoothed gradient, kept by hysteresis.

    J. Canny, A computational approach to edge detection, PAMI 8(6), 1986, doi:10.1109/TPAMI.1986.4767851.
    Edges lie exactly, and end where contrast fades: one gap merges two faces, so regions need linking.
    """

    name = "canny"
    assumptions = ("local_spatial_interaction", "continuity", "gaussian_noise")

    def run(self, inputs: CannyInputs, ctx: Context) -> CannyOutputs:
        """Edges of the image in grey levels of even noise."""
        brightness = graded(inputs.image)
        ctx.measure("noise", brightness.noise)
        ctx.check()
        return CannyOutputs(boundaries=edges_in(brightness, self.params, ctx.scale))


def edges_in(brightness: Brightness, params: CannyParams, scale: int = 1) -> Array:
    """Bool (H, W): edges of an image of a level whose pixels are ``scale`` full-size pixels wide."""
    import cv2

    smooth = cv2.GaussianBlur(brightness.levels, (0, 0), max(params.blur / scale, 0.4))
    across, down = (
        np.clip(np.rint(UNITS * cv2.Sobel(smooth, cv2.CV_32F, *axes)), -32767, 32767).astype(np.int16)
        for axes in ((1, 0), (0, 1))
    )
    heard = params.noise * brightness.noise
    low, high = max(params.low, 0.6 * heard), max(params.high, heard)
    return np.asarray(cv2.Canny(across, down, UNITS * low, UNITS * high, L2gradient=True) > 0)
