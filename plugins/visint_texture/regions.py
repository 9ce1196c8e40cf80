"""``texture.regions``: where there is texture, and where one ends."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Confidence, Features, Regions
from visint.fields import Camera
from visint.module import Context, Module, Params, Ports
from visint_texture.geometry.tangent import log_moments
from visint_texture.surface.mixture import split
from visint_texture.surface.sites import laid_out

__all__ = ["TextureRegions"]


class TextureRegionsParams(Params):
    """Parameters of ``texture.regions``.

    Parameters
    ----------
    cell
        Spacing of the sites that are clustered, full-size pixels.
    least
        How much of a texture there must be.
    jump
        By how much two textures' log moments differ where they meet. Less splits more.
    close
        Gaps of boundaries up to this many full-size pixels are closed before areas are told apart.
    """

    cell: float = Field(default=16.0, gt=0)
    least: float = Field(default=0.2, gt=0, lt=1)
    jump: float = Field(default=0.5, gt=0)
    close: float = Field(default=2.0, ge=0)


class TextureRegionsInputs(Ports):
    """Moments and texture as of ``texture.moments``, and boundaries, which are respected."""

    moments: Features[Array, "H W 3"]
    texture: Confidence[Array, "H W"]
    boundaries: Boundaries[Array, "H W"] | None = None


class TextureRegionsOutputs(Ports):
    """Regions of one texture each, from 1; 0 where there is none and on boundaries."""

    regions: Regions[Array, "H W"]


class TextureRegions(Module[TextureRegionsParams, TextureRegionsInputs, TextureRegionsOutputs]):
    """Regions that each hold one texture on one surface.

    Textured areas between boundaries; where moments jump though no boundary is known, the area is split by
    two laws that each change straight over the image (k-planes; Bradley and Mangasarian 2000,
    doi:10.1023/A:1008324625522), as long as two explain far more than one curved law. A bent surface changes
    its moments smoothly and stays whole. Regions are separate problems to ``texture.super_bovik``.

    Two textures that differ in neither scale nor direction are one to it. Edges between textures are found
    to within about a site.
    """

    name = "regions"
    assumptions = ("homogeneity", "cohesiveness")

    def run(self, inputs: TextureRegionsInputs, ctx: Context) -> TextureRegionsOutputs:
        """Regions of the moments' size."""
        import cv2

        rows, columns = inputs.texture.shape
        textured = inputs.texture > self.params.least
        if inputs.boundaries is not None:
            side = 2 * int(self.params.close / ctx.scale / 2) + 1
            wall = cv2.dilate(inputs.boundaries.astype(np.uint8), np.ones((side, side), np.uint8)) > 0
            textured = textured & ~wall
        _, areas = cv2.connectedComponents(textured.astype(np.uint8), connectivity=4)
        ctx.check()
        cell = max(1, round(self.params.cell / ctx.scale))
        camera = Camera.uncalibrated(columns, rows)
        sites = laid_out(inputs.moments, inputs.texture, camera, cell)
        at = _middles(areas, sites.shape)
        coarse = np.where(sites.weight > self.params.least, at, 0)
        found = split(log_moments(sites.moments), sites.weight, coarse, self.params.jump)
        regions = _refined(areas, coarse, found)
        ctx.measure("regions", float(len(np.unique(regions[regions > 0]))))
        return TextureRegionsOutputs(regions=regions)


def _middles(areas: Array, shape: tuple[int, int]) -> Array:
    """The area at the middle of each site, int (R, C)."""
    rows = ((np.arange(shape[0]) + 0.5) * areas.shape[0] / shape[0]).astype(int)
    columns = ((np.arange(shape[1]) + 0.5) * areas.shape[1] / shape[1]).astype(int)
    return np.asarray(areas[rows[:, None], columns[None, :]])


def _refined(areas: Array, coarse: Array, found: Array) -> Array:
    """Each pixel's area, split as its nearest site of the same area is; areas without sites are dropped."""
    from scipy.ndimage import distance_transform_edt

    regions = np.zeros(areas.shape, np.int32)
    rows, columns = (
        np.minimum((np.arange(n) * k) // n, k - 1) for n, k in zip(areas.shape, coarse.shape, strict=True)
    )
    for area in np.unique(coarse[found > 0]):
        mine = np.where(coarse == area, found, 0)
        near = distance_transform_edt(mine == 0, return_distances=False, return_indices=True)
        label = mine[near[0], near[1]]
        inside = areas == area
        regions[inside] = label[rows[:, None], columns[None, :]][inside]
    return regions
