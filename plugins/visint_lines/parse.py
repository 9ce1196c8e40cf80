"""``lines.parse``: a label map as a line diagram."""

from __future__ import annotations

from math import radians
from typing import ClassVar

import numpy as np
from pydantic import Field

from visint.arrays import Array, Regions, read_only
from visint.module import Context, Module, Params, Ports
from visint_lines.corners import corners
from visint_lines.cracks import Chain, background_of, chains_of, whole
from visint_lines.curves import departure, evenly, smoothed
from visint_lines.diagram import LOOP, Arc, Diagram, assembled

__all__ = ["Parse", "ParseParams", "drawn"]


class ParseParams(Params):
    """Parameters of ``lines.parse``.

    Parameters
    ----------
    smallest
        Area in full-size pixels below which a piece of a region is noise. More drops small faces.
    smoothing
        Sigma, in pixels of the level, of the Gaussian along each line. More rounds corners off.
    corner
        Least turn, radians, of a corner between bent lines (about half of it does between straight ones). Less
        finds blunter corners and takes bends for corners.
    shortest
        Lines shorter than this many pixels of the level between two junctions are no line: one junction it is.
    """

    smallest: float = Field(default=24.0, ge=0)
    smoothing: float = Field(default=1.5, ge=0)
    corner: float = Field(default=radians(36), gt=0)
    shortest: float = Field(default=4.0, ge=0)


class ParseInputs(Ports):
    """Regions, labels from 1, 0 on boundaries between them."""

    regions: Regions[Array, "H W"]


class ParseOutputs(Ports):
    """The line diagram, and the regions between its lines: no pixel is unlabelled, specks are gone."""

    diagram: Diagram
    regions: Regions[Array, "H W"]


class Parse(Module[ParseParams, ParseInputs, ParseOutputs]):
    """Junctions and arcs of a label map: the cracks between its regions, walked as chains and cut at corners.

    No thinning is needed and every face is closed, but a line that ends within a face cannot occur: those are
    ``lines.trace``'s. Three regions meet at each branch; two chains that touch at a point pass each other by.
    """

    name = "parse"
    assumptions: ClassVar[tuple[str, ...]] = ("perfect_segmentation",)

    def run(self, inputs: ParseInputs, ctx: Context) -> ParseOutputs:
        """The diagram in pixels of the level."""
        p = self.params
        labels = whole(inputs.regions, p.smallest / ctx.scale**2)
        ctx.check()
        diagram = drawn(chains_of(labels), p, labels.shape, background_of(labels))
        ctx.measure("arcs", len(diagram.arcs))
        return ParseOutputs(diagram=diagram, regions=labels)


def drawn(chains: list[Chain], params: ParseParams, size: tuple[int, ...], background: int = 0) -> Diagram:
    """The diagram of curves whose open ends are junctions, after smoothing, merging and cutting at corners."""
    places = _Places(params.shortest)
    short = [c for c in chains if not c.closed and len(c.points) - 1 < params.shortest]
    for chain in short:
        places.join(chain.points[0], chain.points[-1])
    arcs: list[Arc] = []
    for chain in chains:
        if chain.closed or len(chain.points) - 1 >= params.shortest:
            arcs += _cut(chain, params, places, background)
    angles = [(0.0, 0.0) if a.closed else (departure(a.points), departure(a.points[::-1])) for a in arcs]
    spots = places.array()
    return assembled((size[0], size[1]), spots, arcs, angles, _on_frame(spots, size))


def _on_frame(spots: Array, size: tuple[int, ...]) -> Array:
    low, high = spots < -0.25, spots > np.array([size[1], size[0]]) - 0.75
    return np.asarray((low | high).any(axis=1))


class _Places:
    """Junctions by where they are; those that a line too short to be one connects are the same."""

    def __init__(self, shortest: float) -> None:
        self.shortest = shortest
        self._spots: list[Array] = []
        self._number: dict[tuple[float, float], int] = {}

    def join(self, one: Array, two: Array) -> None:
        a, b = self.at(one), self.at(two)
        for key, number in self._number.items():
            if number == b:
                self._number[key] = a

    def at(self, spot: Array) -> int:
        """The number of the junction at ``spot`` (2,)."""
        key = (float(spot[0]), float(spot[1]))
        if key not in self._number:
            self._number[key] = len(self._spots)
            self._spots.append(np.asarray(spot, dtype=np.float64))
        return self._number[key]

    def array(self) -> Array:
        """float64 (J, 2)."""
        return np.array(self._spots, dtype=np.float64).reshape(-1, 2)


def _cut(chain: Chain, params: ParseParams, places: _Places, background: int) -> list[Arc]:
    """The arcs of a chain: whole, or in pieces between its corners."""
    points = evenly(smoothed(chain.points, params.smoothing, chain.closed))
    cuts = corners(points, chain.closed, params.corner)
    if chain.closed:
        if not cuts:
            return [_arc(chain, points, (LOOP, LOOP), background)]
        ring = points[:-1]
        points = np.concatenate([ring[cuts[0] :], ring[: cuts[0] + 1]])
        cuts = [0, *(cut - cuts[0] for cut in cuts[1:]), len(points) - 1]
        ends = [places.at(points[cut]) for cut in cuts]
    else:
        cuts = [0, *cuts, len(points) - 1]
        middle = [places.at(points[cut]) for cut in cuts[1:-1]]
        ends = [places.at(chain.points[0]), *middle, places.at(chain.points[-1])]
    return [
        _arc(chain, points[a : b + 1], (start, end), background)
        for a, b, start, end in zip(cuts, cuts[1:], ends, ends[1:], strict=False)
    ]


def _arc(chain: Chain, points: Array, ends: tuple[int, int], background: int) -> Arc:
    side = "left" if chain.left == background else "right" if chain.right == background else ""
    return Arc(*ends, chain.left, chain.right, read_only(points.copy()), side if background else "")
