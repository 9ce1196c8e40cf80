"""Every module of the plugin keeps the contract, with diagrams as other modules of it make them."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array, Depth
from visint.fields import Camera
from visint.module import Context, Ports
from visint.testing import ModuleContract, sample_inputs
from visint_lines.label import Label as LabelModule
from visint_lines.label import LabelInputs
from visint_lines.measure import Features as FeaturesModule
from visint_lines.measure import FeaturesInputs
from visint_lines.parse import Parse as ParseModule
from visint_lines.parse import ParseInputs
from visint_lines.superquadric.module import SuperquadricFit
from visint_lines.trace import Trace as TraceModule


class DepthAndCamera(Ports):
    """Of ``lines.features`` what can be made up."""

    depth: Depth[Array, "H W"]
    camera: Camera


def parsed(size, seed):
    """The drawing of a rectangle before another region, cut by the seed."""
    regions = np.ones(size, np.int32)
    regions[size[0] // 4 : size[0] - size[0] // 4, size[1] // 5 + seed :] = 2
    regions[size[0] // 2 :, size[1] // 2 :] += 2
    return ParseModule().run(ParseInputs(regions=regions), Context())


class TestParse(ModuleContract):
    module = ParseModule


class TestTrace(ModuleContract):
    module = TraceModule


class TestFeatures(ModuleContract):
    module = FeaturesModule

    def make_inputs(self, size, content="noise", seed=0):
        plain = sample_inputs(DepthAndCamera, size, content, seed)
        drawing = parsed(size, seed)
        return FeaturesInputs(
            diagram=drawing.diagram, regions=drawing.regions, depth=plain.depth, camera=plain.camera
        )


class TestLabel(ModuleContract):
    module = LabelModule

    def make_inputs(self, size, content="noise", seed=0):
        measured = FeaturesModule().run(TestFeatures().make_inputs(size, content, seed), Context())
        image = np.full(size, 0.5, np.float32)
        return LabelInputs(diagram=measured.diagram, image=image)


class TestSuperquadric(ModuleContract):
    module = SuperquadricFit
