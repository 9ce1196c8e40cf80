"""``grouping.voronoi``: boundaries linked by the rules of Gestalt."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array
from visint.module import Context, Module, Params
from visint_grouping.gestalt import Weights, coherence, costs, voronoi_neighbours
from visint_grouping.partition import complete, regions_between
from visint_grouping.spoke import GroupingInputs, GroupingOutputs, Scene, answer, near, seen
from visint_grouping.strokes import Sites, sites, stroked, thinned

__all__ = ["Voronoi", "VoronoiParams"]


class VoronoiParams(Params):
    """Parameters of ``grouping.voronoi``.

    Parameters
    ----------
    proximity
        Weight of the squared gap over the product of the lengths of the lines it would join. More refuses
        long links between short lines.
    curvilinearity
        Weight of the angles by which a link leaves the lines' directions. More refuses bends.
    cotermination
        Weight of loneliness: few Voronoi neighbours. More favours links where several lines end together.
    brightness
        Weight of the missing contrast of region means across the link. More refuses links over even ground.
    depth
        Weight of the missing step of depth across it. More refuses links within a surface.
    least
        Links of less coherence are not made. 1 makes none; lower makes more.
    window
        How near, in full-size pixels, segmentations must lie to agree.
    extension
        How far, in full-size pixels, an end is extended at most where two segmentations agree.
    smallest
        Area in full-size pixels below which a closed region is none.
    """

    proximity: float = Field(default=1.0, ge=0)
    curvilinearity: float = Field(default=1.0, ge=0)
    cotermination: float = Field(default=0.5, ge=0)
    brightness: float = Field(default=0.01, ge=0)
    depth: float = Field(default=0.5, ge=0)
    least: float = Field(default=0.8, gt=0, le=1)
    window: float = Field(default=4.0, ge=0, le=64)
    extension: float = Field(default=12.0, ge=0)
    smallest: float = Field(default=16.0, ge=0)

    def weights(self) -> Weights:
        """The five weights."""
        return Weights(self.proximity, self.curvilinearity, self.cotermination, self.brightness, self.depth)


class Voronoi(Module[VoronoiParams, GroupingInputs, GroupingOutputs]):
    """Boundaries that two segmentations agree on, extended along their tangents, their ends linked by Gestalt.

    Sections 3.1 and 5.2.1. Selection: edges (and what the map has where there is no edge) near a boundary of
    another segmentation. Extension: ends go on while two segmentations have a boundary near. Linking: each
    termination takes the cheapest link (Eq. 5.20 as a cost, corrected) to a Voronoi neighbour, termination or
    corner, if its coherence 1/(1 + E/Σw) is enough. Coherence elsewhere is Eq. 5.19. Links are straight.

    ``evidence`` holds open boundaries too; ``regions`` come from those that close.
    """

    name = "voronoi"
    assumptions = ("general_viewpoint", "coherence", "piecewise_continuity")

    def run(self, inputs: GroupingInputs, ctx: Context) -> GroupingOutputs:
        """Boundaries of the view; nothing is kept from turn to turn but what the map brings back."""
        scene = seen(inputs, ctx.scale)
        ctx.check()
        reach = max(round(self.params.window / ctx.scale), 1)
        votes = {name: near(line, reach) for name, line in scene.lines.items()}
        chosen = self._selected(scene, votes)
        lines, ends = self._extended(scene, chosen, reach, ctx.scale)
        ctx.check()
        shade = _shaded(scene)
        lines, links = self._linked(lines, ends, shade, inputs.depth)
        coherence = sum(votes.values(), np.zeros(lines.shape, np.float32)) / np.float32(max(len(votes), 1))
        coherence = np.where(links > 0, links, coherence)
        regions = _closed(lines, self.params.smallest / ctx.scale**2)
        lines = lines | (regions == 0)
        ctx.measure("regions", int(regions.max(initial=0)))
        support = {**votes, "extension": lines & ~chosen & (links == 0), "link": links > 0}
        return answer(lines, regions, coherence, support)

    def _selected(self, scene: Scene, votes: dict[str, Array]) -> Array:
        """Bool (H, W), thin: boundaries near to which another segmentation has one, at the edges' places."""
        agreed = np.add.reduce([vote.astype(np.int8) for vote in votes.values()]) if votes else 0
        lines = np.zeros(scene.regions.shape, dtype=bool)
        for name in ("edges", "map", "depth"):
            if name in scene.lines:
                lines |= scene.lines[name] & ~near(lines, 2)
        return thinned(lines & (np.asarray(agreed) >= 2))

    def _extended(self, scene: Scene, lines: Array, reach: int, scale: int) -> tuple[Array, Sites]:
        """Lines with their extensions, and the sites of the whole."""
        from visint_grouping.lines import _kernels

        strokes = stroked(lines)
        ends = sites(lines, strokes)
        arcs = np.stack(
            [np.where(line & (strokes.arc == 0), -1, 0) for line in scene.lines.values()] or [lines]
        )
        for layer, name in zip(arcs, scene.lines, strict=False):
            layer[...] = np.where(scene.lines[name] & (strokes.arc > 0), strokes.arc, layer)
        added = np.zeros_like(lines)
        own = slice(ends.ends)
        place, longest = ends.place[own].astype(np.int64), round(self.params.extension / scale)
        arguments = (place, ends.way[own], ends.arc[own].astype(np.int64), arcs.astype(np.int32))
        _kernels.extend(lines, *arguments, 2, reach, longest, added)
        longer = thinned(lines | added)
        return longer, sites(longer, stroked(longer))

    def _linked(self, lines: Array, ends: Sites, shade: Array, depth: Array | None) -> tuple[Array, Array]:
        """(lines with links, coherence of the links where there are any, else 0)."""
        import cv2

        weights, drawn = self.params.weights(), np.zeros(lines.shape, np.float32)
        pairs = voronoi_neighbours(ends.place)
        pairs = pairs[pairs[:, 0] < ends.ends]  # a link begins at a termination
        if not len(pairs):
            return lines, drawn
        beta = coherence(costs(ends, pairs, weights, shade, depth), weights, with_depth=depth is not None)
        for link in _best(pairs, beta, ends, self.params.least):
            (r0, c0), (r1, c1) = np.rint(ends.place[pairs[link]]).astype(int).tolist()
            cv2.line(drawn, (c0, r0), (c1, r1), float(beta[link]), 1, cv2.LINE_8)
        drawn[lines] = 0
        return lines | (drawn > 0), drawn


def _best(pairs: Array, beta: Array, ends: Sites, least: float) -> Array:
    """Indices of the pairs that are the most coherent of one of their terminations and at least ``least``."""
    order = np.argsort(-beta, kind="stable")
    best = np.full(len(ends.place), -1, np.int64)
    for column in (0, 1):
        site, first = np.unique(pairs[order, column], return_index=True)
        rival = order[first]
        better = (best[site] < 0) | (beta[rival] > beta[best[site]])
        best[site[better]] = rival[better]
    chosen = np.unique(best[: ends.ends])
    chosen = chosen[chosen >= 0]
    return np.asarray(chosen[beta[chosen] >= least])


def _shaded(scene: Scene) -> Array:
    """float32 (H, W): the mean grey level of the region of each pixel."""
    flat = scene.regions.ravel()
    total = np.bincount(flat, scene.brightness.levels.ravel())
    return np.asarray((total / np.maximum(np.bincount(flat), 1))[scene.regions], dtype=np.float32)


def _closed(lines: Array, smallest: float) -> Array:
    """int32 (H, W): regions that ``lines`` close, large enough, 0 on the lines between two of them."""
    import cv2

    labels = regions_between(lines)
    area = np.bincount(labels.ravel())
    small = area < smallest
    small[0] = False
    whole = complete(np.where(small[labels], 0, labels).astype(np.int32))
    kernel = np.ones((3, 3), np.uint8)
    values = whole.astype(np.float32)
    border = cv2.dilate(values, kernel) != cv2.erode(values, kernel)
    thick = border & lines
    thick[:, :-1] |= (whole[:, :-1] != whole[:, 1:]) & ~thick[:, 1:]
    thick[:-1] |= (whole[:-1] != whole[1:]) & ~thick[1:]
    return regions_between(thick)
