"""What both linkers take and give: segmentations in, boundaries with their coherence and support out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from visint.arrays import Array, Boundaries, Depth, Features, Image, Regions
from visint.fields import BoundariesEvidence
from visint.fields.resampling import region_boundaries
from visint.module import Ports
from visint_grouping.brightness import Brightness, graded
from visint_grouping.canny import CannyParams, edges_in
from visint_grouping.depth_edges import DepthEdgesParams, jumps_in
from visint_grouping.partition import complete, numbered
from visint_grouping.split_merge import SplitMergeParams, regions_in

__all__ = ["SOURCES", "GroupingInputs", "GroupingOutputs", "Scene", "answer", "near", "seen"]

SOURCES = ("edges", "regions", "depth", "map", "extension", "link")
"""The channels of ``support``: the four segmentations, then what grouping itself added."""

SIGMA = 1.0
"""How far, in pixels of the level, a boundary that is there may lie from where it is said to be."""


class GroupingInputs(Ports):
    """A view, segmentations of it, and the map so far.

    ``edges`` (open lines) and ``segments`` (regions, labels from 1, 0 unknown) may come from any module or
    library; where they are not given, ``grouping.canny`` and ``grouping.split_merge`` do it with their
    defaults. ``depth`` and ``boundaries`` are the map's: the third and the fourth segmentation.
    """

    image: Image[Array, "H W"]
    edges: Boundaries[Array, "H W"] | None = None
    segments: Regions[Array, "H W"] | None = None
    depth: Depth[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None


class GroupingOutputs(Ports):
    """Boundaries, the regions they close, and what each boundary pixel was supported by.

    ``evidence``: reliability is the coherence of a boundary pixel, in [0, 1]; where there is none, how sure
    that is. ``regions``: labels from 1, 0 on the boundaries between them. ``support``: one channel for each of
    edges, regions, depth, map, extension and link; 1 where the boundary pixel was supported by it, 0 elsewhere.
    """

    evidence: BoundariesEvidence
    regions: Regions[Array, "H W"]
    support: Features[Array, "H W 6"]


class Scene(NamedTuple):
    """One view as grouping sees it.

    ``regions``: int32 (H, W), a region of the region segmentation for each pixel, from 0. ``lines``: bool
    (H, W), the boundaries of each segmentation that takes part, by source.
    """

    brightness: Brightness
    regions: Array
    lines: Mapping[str, Array]


def seen(inputs: GroupingInputs, scale: int) -> Scene:
    """The view and its segmentations; what is not given is made. One that sees nothing takes no part."""
    brightness = graded(inputs.image)
    edges = inputs.edges if inputs.edges is not None else edges_in(brightness, CannyParams(), scale)
    if inputs.segments is None:
        regions = regions_in(brightness, SplitMergeParams(), scale)
    else:
        regions = numbered(complete(np.maximum(inputs.segments, 0)))[0]
    lines = {"edges": edges, "regions": region_boundaries(regions + 1)}
    if inputs.depth is not None:
        lines["depth"] = jumps_in(inputs.depth, DepthEdgesParams(), scale)
    if inputs.boundaries is not None:
        lines["map"] = inputs.boundaries
    return Scene(brightness, regions, {name: line for name, line in lines.items() if line.any()})


def near(lines: Array, reach: int) -> Array:
    """Bool (H, W): within ``reach`` pixels of a set pixel of ``lines``, in a square."""
    import cv2

    side = 2 * reach + 1
    return np.asarray(cv2.dilate(lines.astype(np.uint8), np.ones((side, side), np.uint8)) > 0)


def answer(
    boundaries: Array, regions: Array, coherence: Array, support: Mapping[str, Array]
) -> GroupingOutputs:
    """The outputs of a linker.

    ``coherence``: float32 (H, W), for every pixel the share of what speaks for a boundary there; ``support``:
    bool or float (H, W) by source, what speaks at each pixel.
    """
    trust = np.where(boundaries, coherence, 1 - coherence)
    channels = np.zeros((*boundaries.shape, len(SOURCES)), np.float32)
    for name, where in support.items():
        channels[..., SOURCES.index(name)] = where * boundaries
    return GroupingOutputs(
        evidence=BoundariesEvidence.of(boundaries, SIGMA, trust), regions=regions, support=channels
    )
