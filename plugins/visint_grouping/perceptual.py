"""``grouping.perceptual``: boundaries that are closed by construction."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array
from visint.module import Context, Module, Params
from visint_grouping.basins import along, basins, steps, taps
from visint_grouping.partition import arcs_of, separated, united
from visint_grouping.spoke import GroupingInputs, GroupingOutputs, Scene, answer, near, seen

__all__ = ["Perceptual", "PerceptualParams"]

ACROSS = 4
"""Pixels on either side of a crack whose mean brightness is compared; one more where a slope is fitted."""
Cracks = list[tuple[Array, Array]]
ECHO = 0.1
"""How much votes of edges and regions count in the second merging, where shading explains what they see."""


class PerceptualParams(Params):
    """Parameters of ``grouping.perceptual``.

    Parameters
    ----------
    contrast
        Grey levels of contrast that make a boundary. More gives fewer regions.
    chance
        How many standard deviations of the noise are added to that: of the mean along the whole boundary, so a
        long faint one survives and a short one does not. More gives fewer regions in noisy images.
    edges, regions
        What it is worth, in grey levels, that a boundary lies along an edge, or an outline of a region: half of
        it is gained if it does everywhere, half lost if it does nowhere. More follows the segmentations.
    depth, map
        What it is worth that depth jumps there, or that the map has a boundary already. Nothing is lost
        without. Much worth for the map keeps what was once said.
    shading
        Grey levels by which two regions may leave a common parabola of brightness, and step at their border
        (the mean of both), and still be one surface. More joins the bands into which a shaded surface falls,
        and faint neighbours. 0 joins none.
    smallest
        Area in full-size pixels below which a region joins the neighbour it is most like.
    """

    contrast: float = Field(default=6.0, gt=0)
    chance: float = Field(default=3.0, ge=0)
    edges: float = Field(default=25.0, ge=0)
    regions: float = Field(default=30.0, ge=0)
    depth: float = Field(default=60.0, ge=0)
    map: float = Field(default=10.0, ge=0)
    shading: float = Field(default=8.0, ge=0)
    smallest: float = Field(default=40.0, ge=0)


class Perceptual(Module[PerceptualParams, GroupingInputs, GroupingOutputs]):
    """Closed boundaries: small basins merge where edges, regions, depth and contrast divide them too little.

    The selection of section 3.1, made on a region adjacency graph: the watershed basins of the brightness
    gradient merge, cheapest first, by the step of brightness along their common arc (less what chance and a
    steady shade explain) and by the share of the arc that each segmentation supports; then by whether one
    parabola of brightness fits both. Coherence is Eq. 5.19 with this partition as one more segmentation.

    Assumes steps of brightness (or of depth) at boundaries and smooth shading between them; texture falls into
    many regions.
    """

    name = "perceptual"
    assumptions = ("general_viewpoint", "coherence", "cohesiveness", "gaussian_noise")

    def run(self, inputs: GroupingInputs, ctx: Context) -> GroupingOutputs:
        """Boundaries of the view; nothing is kept from turn to turn but what the map brings back."""
        scene = seen(inputs, ctx.scale)
        ctx.check()
        labels, count = basins(scene.brightness.levels, scene.brightness.noise, scene.lines.values())
        ctx.check()
        levels = scene.brightness.levels
        across = [steps(levels, taps(ACROSS, sloped=False)), steps(levels, taps(ACROSS + 1, sloped=True))]
        labels, count = self._by_step(scene, across, labels, count)
        ctx.check()
        labels, count = self._by_shading(scene, across, labels, count, ctx.scale)
        ctx.measure("regions", count)
        boundaries, regions = separated(labels)
        votes = {name: near(line, 1) for name, line in scene.lines.items()}
        coherence = sum(votes.values(), boundaries.astype(np.float32)) / np.float32(len(votes) + 1)
        return answer(boundaries, regions, coherence, votes)

    def _votes(self, scene: Scene, echo: float = 1.0) -> tuple[Cracks, list[float]]:
        """For each segmentation what it says of every crack, and what that is worth."""
        said: Cracks = []
        worth = []
        for name, line in scene.lines.items():
            counts = name in ("edges", "regions")
            right, lower = along(line, loosely=counts)
            said.append((right - 0.5, lower - 0.5) if counts else (right, lower))
            worth.append(getattr(self.params, name) * (echo if counts else 1.0))
        return said, worth

    def _by_step(self, scene: Scene, across: Cracks, labels: Array, count: int) -> tuple[Array, int]:
        """Merges over arcs with too little step of brightness, votes counted in."""
        from visint_grouping import _kernels

        said, worth = self._votes(scene)
        arcs = arcs_of(labels, [*across, *said], signed=2)
        chance = self.params.chance * scene.brightness.noise * np.sqrt(2 / ACROSS)
        numbers = np.array([self.params.contrast, chance, *worth])
        home = _kernels.merge(*arcs, 2, np.zeros((count, 1)), _kernels.BY_STEP, numbers)
        return united(labels, home)

    def _by_shading(
        self, scene: Scene, across: Cracks, labels: Array, count: int, scale: int
    ) -> tuple[Array, int]:
        """Merges regions that one parabola of brightness fits about as well as two, without a step between."""
        from visint_grouping import _kernels

        levels, noise = scene.brightness
        if self.params.shading == 0:
            return labels, count
        said, worth = self._votes(scene, ECHO)
        arcs = arcs_of(labels, [*across, *said], signed=2)
        regional = np.zeros((count, 22))
        _kernels.moments(labels, levels, regional)
        numbers = np.array([self.params.shading, 4 * noise, *worth, self.params.smallest / scale**2])
        home = _kernels.merge(*arcs, 2, regional, _kernels.BY_SHADING, numbers)
        return united(labels, home)
