"""Rendering as a node of a graph: a pair with its truth where a file would be."""

from __future__ import annotations

from pydantic import Field, field_validator

from visint.arrays import Array, Boundaries, Depth, Disparity, Image, Mask, Normals, Regions
from visint.fields import Camera, Light
from visint.module import Context, Module, Params, Ports

__all__ = ["Render"]


class RenderParams(Params):
    """Which scene, how large and how fine.

    Parameters
    ----------
    scene
        A name of :func:`visint_lab.scenes.names` that needs no data files, or ``demo``.
    size
        Rows and columns.
    pose
        Seed of a random pose; -1 is the chosen one.
    samples
        Rays a pixel along each side: 1 is jagged, 3 smooth; time grows with the square.
    """

    scene: str = "demo"
    size: int = Field(256, ge=16, le=4096)
    pose: int = Field(-1, ge=-1)
    samples: int = Field(3, ge=1, le=16)

    @field_validator("scene")
    @classmethod
    def _known(cls, name: str) -> str:
        from visint_lab.scenes import names

        known = ["demo", *(one for one in names() if "mozart" not in one and not one.startswith("range"))]
        if name not in known:
            raise ValueError(f"there is no such scene; scenes: {', '.join(known)}")
        return name


class RenderInputs(Ports):
    """Nothing."""


class RenderOutputs(Ports):
    """The pair, its camera and light in the left camera's frame, and the truth; unknown is NaN."""

    left: Image[Array, "H W"]
    right: Image[Array, "H W"]
    camera: Camera
    light: Light
    depth: Depth[Array, "H W"]
    disparity: Disparity[Array, "H W"]
    normals: Normals[Array, "H W 3"]
    visible: Mask[Array, "H W"]
    regions: Regions[Array, "H W"]
    boundaries: Boundaries[Array, "H W"]


class Render(Module[RenderParams, RenderInputs, RenderOutputs]):
    """Renders a scene of the lab as a rectified pair with exact truth, by ray casting.

    ``boundaries`` are limbs, occluding edges and creases; marks and shadows are none.
    """

    name = "render"

    def run(self, inputs: RenderInputs, ctx: Context) -> RenderOutputs:
        """The pair and its truth."""
        from visint_lab.render.edges import CONCAVE, NO_EDGE
        from visint_lab.render.rendering import render
        from visint_lab.scenes import scene

        ctx.check()
        wanted = self.params
        pair = render(
            scene(wanted.scene, wanted.size, None if wanted.pose < 0 else wanted.pose), wanted.samples
        )
        truth = pair.truth
        return RenderOutputs(
            left=pair.left,
            right=pair.right,
            camera=pair.camera,
            light=pair.light,
            depth=truth.depth,
            disparity=truth.disparity,
            normals=truth.normals,
            visible=truth.visible,
            regions=truth.regions,
            boundaries=(truth.edges > NO_EDGE) & (truth.edges <= CONCAVE),
        )
