"""``bayes.surface``: a disparity map as the depth that a map can start from."""

from __future__ import annotations

from visint.arrays import Array, Depth, Disparity
from visint.fields import Camera
from visint.fields.geometry import depth_from_disparity
from visint.module import Context, Module, Params, Ports

__all__ = ["Surface"]


class SurfaceInputs(Ports):
    """A disparity map; without a camera 53° of view and a baseline of 1."""

    disparity: Disparity[Array, "H W"]
    camera: Camera | None = None


class SurfaceOutputs(Ports):
    """Its depth, NaN at or behind infinity."""

    depth: Depth[Array, "H W"]


class Surface(Module[Params, SurfaceInputs, SurfaceOutputs]):
    """Depth from disparity, Z = f B / (d + doffs), whether or not there is a calibration.

    For maps that start from a matched surface (``start: {depth: surface.depth}``).
    """

    name = "surface"

    def run(self, inputs: SurfaceInputs, ctx: Context) -> SurfaceOutputs:
        """The conversion."""
        ctx.check()
        rows, columns = inputs.disparity.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        return SurfaceOutputs(depth=depth_from_disparity(inputs.disparity, camera))
