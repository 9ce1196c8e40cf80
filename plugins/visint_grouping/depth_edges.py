"""``grouping.depth_edges``: where depth jumps."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Depth
from visint.module import Context, Module, Params, Ports

__all__ = ["DepthEdges", "DepthEdgesParams", "jumps_in"]

UNITS = 16384.0
"""Whole numbers for a relative change of 1 a pixel; beyond twice that it is a jump in any case."""


class DepthEdgesParams(Params):
    """Parameters of ``grouping.depth_edges``.

    Parameters
    ----------
    jump
        The relative change of depth over one full-size pixel that counts as a jump; half of it continues one.
        A surface slanted by 80° before a camera of f = 800 px changes by 0.007.
    """

    jump: float = Field(default=0.015, gt=0, le=1)


class DepthEdgesInputs(Ports):
    """The map's depth."""

    depth: Depth[Array, "H W"]


class DepthEdgesOutputs(Ports):
    """``boundaries``: lines along which depth jumps, one pixel wide."""

    boundaries: Boundaries[Array, "H W"]


class DepthEdges(Module[DepthEdgesParams, DepthEdgesInputs, DepthEdgesOutputs]):
    """Depth discontinuities: Sobel's gradient of log depth, thinned, kept by hysteresis (section 5.2.1).

    Where depth or a neighbour is unknown there is no edge.
    """

    name = "depth_edges"
    assumptions = ("smoothness", "opacity")

    def run(self, inputs: DepthEdgesInputs, ctx: Context) -> DepthEdgesOutputs:
        """Jumps of depth at this level."""
        ctx.check()
        return DepthEdgesOutputs(boundaries=jumps_in(inputs.depth, self.params, ctx.scale))


def jumps_in(depth: Array, params: DepthEdgesParams, scale: int = 1) -> Array:
    """Bool (H, W): jumps of ``depth`` (NaN unknown) where pixels are ``scale`` full-size pixels wide."""
    import cv2

    known = np.isfinite(depth) & (depth > 0)
    log = np.log(np.where(known, depth, 1)).astype(np.float32)
    whole = cv2.erode(known.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    gradient = []
    for axes in ((1, 0), (0, 1)):
        change = np.where(whole, cv2.Sobel(log, cv2.CV_32F, *axes, scale=1 / 8), 0)
        gradient.append(np.clip(np.rint(UNITS * change), -32767, 32767).astype(np.int16))
    high = UNITS * min(params.jump * scale, 1.0)
    return np.asarray(cv2.Canny(gradient[0], gradient[1], high / 2, high, L2gradient=True) > 0)
