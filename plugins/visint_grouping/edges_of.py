"""``grouping.edges_of``: regions as boundaries."""

from __future__ import annotations

from visint.arrays import Array, Boundaries, Regions
from visint.fields.resampling import region_boundaries
from visint.module import Context, Module, Params, Ports

__all__ = ["EdgesOf"]


class EdgesOfInputs(Ports):
    """Regions, 0 on boundaries."""

    regions: Regions[Array, "H W"]


class EdgesOfOutputs(Ports):
    """Label 0, and pixels whose right or lower neighbour has another label."""

    boundaries: Boundaries[Array, "H W"]


class EdgesOf(Module[Params, EdgesOfInputs, EdgesOfOutputs]):
    """The boundaries of regions, at any level: regions go down a level by their most frequent label."""

    name = "edges_of"

    def run(self, inputs: EdgesOfInputs, ctx: Context) -> EdgesOfOutputs:
        """Nothing to choose."""
        ctx.check()
        return EdgesOfOutputs(boundaries=region_boundaries(inputs.regions))
