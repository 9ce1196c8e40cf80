"""Every module of the plugin keeps the contract."""

from __future__ import annotations

from visint.testing import ModuleContract
from visint_grouping.canny import Canny as CannyModule
from visint_grouping.depth_edges import DepthEdges as DepthEdgesModule
from visint_grouping.diffuse import Diffuse as DiffuseModule
from visint_grouping.edges_of import EdgesOf as EdgesOfModule
from visint_grouping.perceptual import Perceptual as PerceptualModule
from visint_grouping.planes.guide import Guide as GuideModule
from visint_grouping.planes.mend import Mend as MendModule
from visint_grouping.planes.region_planes import RegionPlanes as RegionPlanesModule
from visint_grouping.split_merge import SplitMerge as SplitMergeModule
from visint_grouping.superpixels import Superpixels as SuperpixelsModule
from visint_grouping.voronoi import Voronoi as VoronoiModule


class TestCanny(ModuleContract):
    module = CannyModule


class TestDepthEdges(ModuleContract):
    module = DepthEdgesModule


class TestDiffuse(ModuleContract):
    module = DiffuseModule


class TestEdgesOf(ModuleContract):
    module = EdgesOfModule


class TestGuide(ModuleContract):
    module = GuideModule


class TestMend(ModuleContract):
    module = MendModule


class TestPerceptual(ModuleContract):
    module = PerceptualModule


class TestRegionPlanes(ModuleContract):
    module = RegionPlanesModule


class TestSplitMerge(ModuleContract):
    module = SplitMergeModule


class TestSuperpixels(ModuleContract):
    module = SuperpixelsModule


class TestVoronoi(ModuleContract):
    module = VoronoiModule
