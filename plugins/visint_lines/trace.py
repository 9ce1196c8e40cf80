"""``lines.trace``: an open edge map as a line diagram."""

from __future__ import annotations

from math import radians
from typing import ClassVar

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, Regions
from visint.module import Context, Module, Params, Ports
from visint_lines.cracks import Chain
from visint_lines.diagram import Diagram
from visint_lines.parse import ParseParams, drawn

__all__ = ["Trace", "TraceParams"]


class TraceParams(Params):
    """Parameters of ``lines.trace``.

    Parameters
    ----------
    spur
        Full-size pixels below which a loose end at a branch is a wart of thinning. More drops short lines too.
    merge
        Full-size pixels below which two branches are one junction.
    smoothing, corner
        As in ``lines.parse``.
    """

    spur: float = Field(default=10.0, ge=0)
    merge: float = Field(default=7.0, ge=0)
    smoothing: float = Field(default=1.5, ge=0)
    corner: float = Field(default=radians(36), gt=0)


class TraceInputs(Ports):
    """Edges, and regions if any are known: what lies on either hand of a line is then told."""

    edges: Boundaries[Array, "H W"]
    regions: Regions[Array, "H W"] | None = None


class TraceOutputs(Ports):
    """The line diagram; its lines may end anywhere."""

    diagram: Diagram


class Trace(Module[TraceParams, TraceInputs, TraceOutputs]):
    """Junctions and arcs of an edge map, thinned to a skeleton, without its spurs.

    For lines that end inside a face, which no label map can hold. Thick or noisy edges grow branches that
    nothing in the scene has; where regions are known, ``lines.parse`` is surer.
    """

    name = "trace"
    assumptions: ClassVar[tuple[str, ...]] = ("piecewise_continuity",)

    def run(self, inputs: TraceInputs, ctx: Context) -> TraceOutputs:
        """The diagram in pixels of the level."""
        p = self.params
        skeleton = _pruned(inputs.edges, p.spur / ctx.scale)
        ctx.check()
        size = skeleton.shape
        chains = [_chain(*walk, inputs.regions) for walk in _walked(skeleton)]
        merge = max(2.0, p.merge / ctx.scale)
        params = ParseParams(smoothing=p.smoothing, corner=p.corner, shortest=merge)
        return TraceOutputs(diagram=drawn(chains, params, size))


def _walked(skeleton: Array) -> list[tuple[Array, bool]]:
    """(points (N, 2) row and column, closed) of every chain."""
    from visint_lines import _kernels

    points, first, closed = _kernels.walks(skeleton)
    return [(points[first[i] : first[i + 1]], bool(closed[i])) for i in range(len(closed))]


def _pruned(edges: Array, spur: float) -> Array:
    """The skeleton without chains shorter than ``spur`` that hang loose from a branch."""
    from visint_lines import _kernels

    skeleton = np.ascontiguousarray(_kernels.thinned(edges))
    for _ in range(2):
        walks = [points for points, closed in _walked(skeleton) if not closed]
        ends = [tuple(map(int, end)) for points in walks for end in (points[0], points[-1])]
        loose = {end for end in ends if ends.count(end) == 1}
        for points in walks:
            tips = [tuple(map(int, end)) in loose for end in (points[0], points[-1])]
            if len(points) < spur and tips[0] != tips[1]:
                own = points[:-1] if tips[0] else points[1:]
                skeleton[own[:, 0], own[:, 1]] = False
    return skeleton


def _chain(points: Array, closed: bool, regions: Array | None) -> Chain:
    places = points[:, ::-1].astype(np.float64)
    return Chain(places, closed, *_hands(places, regions))


def _hands(places: Array, regions: Array | None) -> tuple[int, int]:
    """The regions two pixels to the left and right of the middle of a line; 0 where not known."""
    if regions is None or len(places) < 2:
        return 0, 0
    middle = len(places) // 2
    along = places[min(middle + 2, len(places) - 1)] - places[max(middle - 2, 0)]
    across = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-9)
    found = []
    for side in (-2.0, 2.0):
        column, row = np.rint(places[middle] + side * across).astype(int)
        inside = 0 <= row < regions.shape[0] and 0 <= column < regions.shape[1]
        found.append(int(regions[row, column]) if inside else 0)
    return found[0], found[1]
