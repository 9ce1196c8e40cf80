"""Perceptual grouping: edges and regions of an image, the boundaries they agree on, and depth between them."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_grouping.canny import Canny
    from visint_grouping.depth_edges import DepthEdges
    from visint_grouping.diffuse import Diffuse
    from visint_grouping.edges_of import EdgesOf
    from visint_grouping.perceptual import Perceptual
    from visint_grouping.planes.guide import Guide
    from visint_grouping.planes.mend import Mend
    from visint_grouping.planes.region_planes import RegionPlanes
    from visint_grouping.split_merge import SplitMerge
    from visint_grouping.superpixels import Superpixels
    from visint_grouping.voronoi import Voronoi

    found = [Canny, DepthEdges, Diffuse, EdgesOf, Guide, Mend, Perceptual]
    return [*found, RegionPlanes, SplitMerge, Superpixels, Voronoi]
