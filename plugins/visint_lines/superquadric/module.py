"""``lines.superquadric``: a superquadric for each region's depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from pydantic import Field

from visint.arrays import Array, Color, Confidence, Depth, Image, Regions
from visint.fields import Camera, geometry, known
from visint.module import Context, Module, Params, Ports
from visint_lines.superquadric.fit import Fit, fitted
from visint_lines.superquadric.shape import mesh
from visint_lines.superquadric.wires import drawn

__all__ = ["Fits", "SuperquadricFit", "SuperquadricParams"]

RINGS = 160
"""Rays around an outline at most."""


@dataclass(frozen=True, eq=False)
class Fits:
    """Region by region its superquadric; regions that none was fitted to are missing."""

    __kind__: ClassVar[str] = "lines.Superquadrics"

    of: tuple[tuple[int, Fit], ...] = ()


class SuperquadricParams(Params):
    """Parameters of ``lines.superquadric``.

    Parameters
    ----------
    smallest
        Area in full-size pixels below which a region gets no fit. More leaves small parts out.
    margin
        Full-size pixels next to a region's outline that take no part: depth there is least sure. More trusts
        the outline for the body's extent.
    background
        Whether the region that holds most of the image's frame gets a fit too.
    most
        Regions at most, the largest first; each costs about a tenth of a second.
    """

    smallest: float = Field(default=400.0, ge=0)
    margin: float = Field(default=1.0, ge=0)
    background: bool = False
    most: int = Field(default=12, ge=1)


class SuperquadricInputs(Ports):
    """Regions, labels from 1, one a body or part; depth; and the image that the fits are drawn over."""

    regions: Regions[Array, "H W"]
    depth: Depth[Array, "H W"]
    camera: Camera | None = None
    image: Image[Array, "H W"] | None = None


class SuperquadricOutputs(Ports):
    """The fits; how well each region is described, exp(−rms²/(2 (0.05 r)²)) with r its extent; the drawing.

    ``drawing``: the wire frames over the image.
    """

    fits: Fits
    fitness: Confidence[Array, "H W"]
    drawing: Color[Array, "H W 3"]


class SuperquadricFit(Module[SuperquadricParams, SuperquadricInputs, SuperquadricOutputs]):
    """Fits a superquadric to the depth of each region: size, roundness, pose (Figs. 4.16 and 5.24).

    Least squares over the radial distance (Solina and Bajcsy 1990, DOI 10.1109/34.44401) from several starts;
    rays just outside the region's outline keep the hidden half from growing where background lies around it.

    Assumes one convex symmetric body a region. The hidden half follows from symmetry; the far side of a box
    that shows one face is not to be known.
    """

    name = "superquadric"
    assumptions: ClassVar[tuple[str, ...]] = ("symmetry", "perfect_segmentation", "opacity")

    def run(self, inputs: SuperquadricInputs, ctx: Context) -> SuperquadricOutputs:
        """One fit a region that is large enough."""
        p, size = self.params, inputs.regions.shape
        camera = inputs.camera or Camera.uncalibrated(size[1], size[0])
        places = geometry.back_project(inputs.depth, camera).astype(np.float64)
        fits: list[tuple[int, Fit]] = []
        fitness = np.zeros(size, np.float32)
        for label in _chosen(inputs.regions, p, ctx.scale):
            ctx.check()
            inside = inputs.regions == label
            points = places[_shrunk(inside, p.margin / ctx.scale) & known(inputs.depth)]
            found = fitted(points, _rays_around(inside, inputs.regions, camera))
            if found is not None:
                fits.append((label, found))
                fitness[inside] = _worth(found, points)
        ground = inputs.image if inputs.image is not None else np.zeros(size, np.float32)
        ctx.check()
        wires = [mesh(found.shape) for _, found in fits]
        return SuperquadricOutputs(
            fits=Fits(tuple(fits)), fitness=fitness, drawing=drawn(ground, wires, camera)
        )


def _chosen(regions: Array, p: SuperquadricParams, scale: int) -> list[int]:
    from visint_lines.cracks import background_of

    labels, areas = np.unique(regions[regions > 0], return_counts=True)
    ground = 0 if p.background else background_of(regions)
    order = np.lexsort((labels, -areas))
    kept = [int(labels[i]) for i in order if areas[i] >= p.smallest / scale**2 and labels[i] != ground]
    return kept[: p.most]


def _shrunk(inside: Array, margin: float) -> Array:
    import cv2

    reach = round(margin)
    if reach < 1:
        return inside
    kernel = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    return np.asarray(cv2.erode(inside.astype(np.uint8), kernel, borderValue=0) > 0)


def _rays_around(inside: Array, regions: Array, camera: Camera) -> Array:
    """(M, 3): unit rays a pixel outside the region, where it borders the background; none elsewhere."""
    import cv2

    from visint_lines.cracks import background_of

    ring = (cv2.dilate(inside.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0) & ~inside
    ground = background_of(regions)
    row, column = np.nonzero(ring & (regions == ground)) if ground else (np.empty(0, int), np.empty(0, int))
    if not len(row):
        return np.empty((0, 3))
    few = np.linspace(0, len(row) - 1, min(RINGS, len(row))).astype(int)
    across, down = (column[few] - camera.cx) / camera.focal_length, (row[few] - camera.cy) / camera.focal_length
    rays = np.stack([across, down, np.ones_like(across)], axis=-1)
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def _worth(found: Fit, points: Array) -> float:
    extent = 0.05 * float(np.linalg.norm(points.std(axis=0)))
    return float(np.exp(-0.5 * (found.rms / max(extent, 1e-12)) ** 2))
