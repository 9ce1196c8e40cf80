"""``grouping.split_merge``: the regions of an image."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Image, Regions
from visint.module import Context, Module, Params, Ports
from visint_grouping.brightness import Brightness, graded
from visint_grouping.partition import arcs_of, numbered, separated, united

__all__ = ["SplitMerge", "SplitMergeParams", "regions_in"]

LARGEST = 64
"""Side of the squares that splitting begins with."""
SWEEPS = 4


class SplitMergeParams(Params):
    """Parameters of ``grouping.split_merge``.

    Parameters
    ----------
    difference
        Grey levels by which the means of two regions may differ and still be merged; half of it is the spread
        a square may have and not be split. More gives fewer regions and loses faint ones.
    chance
        How many standard deviations of the noise may be added to that.
    block
        Side of the smallest square, full-size pixels, a power of two. Smaller sees smaller things, and more
        noise.
    stiffness
        What a neighbour of another region costs a pixel when outlines settle, in variances of the noise.
        More is smoother.
    """

    difference: float = Field(default=10.0, gt=0)
    chance: float = Field(default=3.0, ge=0)
    block: int = Field(default=4, ge=1, le=32)
    stiffness: float = Field(default=1.0, ge=0)


class SplitMergeInputs(Ports):
    """One view."""

    image: Image[Array, "H W"]


class SplitMergeOutputs(Ports):
    """``regions``: labels from 1, 0 on outlines; ``boundaries``: the outlines, all closed."""

    regions: Regions[Array, "H W"]
    boundaries: Boundaries[Array, "H W"]


class SplitMerge(Module[SplitMergeParams, SplitMergeInputs, SplitMergeOutputs]):
    """Regions of even brightness: a quadtree splits the image, alike neighbours merge, outlines settle.

    After T. Pavlidis, Structural Pattern Recognition, 1977, with thresholds
    that allow for the noise measured. Every region is closed; a shaded surface falls into bands.
    """

    name = "split_merge"
    assumptions = ("cohesiveness", "gaussian_noise")

    def run(self, inputs: SplitMergeInputs, ctx: Context) -> SplitMergeOutputs:
        """Regions of the image in grey levels of even noise."""
        brightness = graded(inputs.image)
        ctx.check()
        boundaries, regions = separated(regions_in(brightness, self.params, ctx.scale))
        ctx.measure("regions", int(regions.max(initial=0)))
        return SplitMergeOutputs(regions=regions, boundaries=boundaries)


def regions_in(brightness: Brightness, params: SplitMergeParams, scale: int = 1) -> Array:
    """int32 (H, W): the region of each pixel, from 0."""
    from visint_grouping import _kernels

    levels, noise = brightness.levels, max(brightness.noise, 1.0)
    labels = np.zeros(levels.shape, np.int32)
    block = 1 << int(np.log2(max(params.block // scale, 1)))
    spread = float(np.hypot(noise, params.difference / 2))
    count = _kernels.split(levels, spread, block, max(LARGEST, block), labels)
    labels, count = _merged(labels - 1, count, levels, (params.difference, params.chance * noise))
    for _ in range(SWEEPS):
        area, total = _sums(labels, count, levels)
        means = total / np.maximum(area, 1)
        _kernels.settle(levels, means, 2 * noise**2, params.stiffness, labels)
    return numbered(labels)[0]


def _sums(labels: Array, count: int, levels: Array) -> tuple[Array, Array]:
    """(pixels, summed grey levels) of each region."""
    flat = labels.ravel()
    return np.bincount(flat, minlength=count).astype(float), np.bincount(flat, levels.ravel(), count)


def _merged(labels: Array, count: int, levels: Array, limits: tuple[float, float]) -> tuple[Array, int]:
    from visint_grouping import _kernels

    regional = np.stack(_sums(labels, count, levels), axis=1)
    arcs = arcs_of(labels)
    home = _kernels.merge(*arcs, 0, regional, _kernels.BY_MEANS, np.array(limits))
    return united(labels, home)
