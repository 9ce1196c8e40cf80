"""Between disparity, depth and normals, as nodes of a graph."""

from __future__ import annotations

from visint.arrays import Array, Depth, Disparity, Normals
from visint.fields import Camera
from visint.fields.geometry import depth_from_disparity, disparity_from_depth, normals_from_depth
from visint.module import Context, Module, Params, Ports

__all__ = ["DepthFromDisparity", "DisparityFromDepth", "NormalsFromDepth"]


class NoParams(Params):
    """Geometry has nothing to choose."""


class DisparityAndCamera(Ports):
    """Disparity of the left view in pixels of its level, and the camera of that level."""

    disparity: Disparity[Array, "H W"]
    camera: Camera


class DepthAndCamera(Ports):
    """Depth along the optical axis in the unit of the baseline, and the camera of its level."""

    depth: Depth[Array, "H W"]
    camera: Camera


class DepthOnly(Ports):
    """Depth, NaN where the disparity is unknown or puts the point behind infinity."""

    depth: Depth[Array, "H W"]


class DisparityOnly(Ports):
    """Disparity, NaN where the depth is unknown or not positive."""

    disparity: Disparity[Array, "H W"]


class NormalsOnly(Ports):
    """Unit normals facing the camera (n_z < 0)."""

    normals: Normals[Array, "H W 3"]


class DepthFromDisparity(Module[NoParams, DisparityAndCamera, DepthOnly]):
    """Depth from disparity: Z = f B / (d + doffs)."""

    name = "depth"

    def run(self, inputs: DisparityAndCamera, ctx: Context) -> DepthOnly:
        """Depth of each pixel whose disparity is known."""
        return DepthOnly(depth=depth_from_disparity(inputs.disparity, inputs.camera))


class DisparityFromDepth(Module[NoParams, DepthAndCamera, DisparityOnly]):
    """Disparity from depth: d = f B / Z - doffs. The way back from the map to the matcher."""

    name = "disparity"

    def run(self, inputs: DepthAndCamera, ctx: Context) -> DisparityOnly:
        """Disparity of each pixel whose depth is known and positive."""
        return DisparityOnly(disparity=disparity_from_depth(inputs.depth, inputs.camera))


class NormalsFromDepth(Module[NoParams, DepthAndCamera, NormalsOnly]):
    """Normals of the perspective surface of a depth map, by central differences."""

    name = "normals"

    def run(self, inputs: DepthAndCamera, ctx: Context) -> NormalsOnly:
        """Unit normals; NaN where depth or both of its neighbours along an axis are unknown."""
        return NormalsOnly(normals=normals_from_depth(inputs.depth, inputs.camera))
