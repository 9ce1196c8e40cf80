"""Cutting arcs where a limb begins or ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from visint.arrays import Array, read_only
from visint_lines.curves import departure
from visint_lines.diagram import LOOP, Arc, Diagram, assembled
from visint_lines.limbness import LimbPoints, limb_runs, withdrawn

__all__ = ["SHORTEST", "split"]

SHORTEST = 12
"""Points that a piece between two cuts has at least."""


def split(
    diagram: Diagram, arc_of: Array, index: Array, points: LimbPoints, blur: float
) -> tuple[Diagram, Array]:
    """The diagram with its arcs cut between limb and no limb, and the new arc of each section.

    Parameters
    ----------
    arc_of, index
        int (N,): arc of each section, and the point it goes through.
    points
        (N,): whether the section is a limb's, whether it can tell, and the angle at the line.
    blur
        Pixels by which depth is blurred: neighbouring sections then err together.
    """
    spots = [(j.x, j.y) for j in diagram.junctions]
    frame = [j.frame for j in diagram.junctions]
    smooth = [j.smooth for j in diagram.junctions]
    arcs: list[Arc] = []
    owner = np.empty(len(arc_of), dtype=np.int64)
    for number, arc in enumerate(diagram.arcs):
        mine = np.flatnonzero(arc_of == number)
        runs = limb_runs(points.passed[mine], points.asked[mine], arc.closed, blur)
        cuts = _cuts(arc, index[mine], withdrawn(runs, points.edge[mine], arc.closed))
        owner[mine] = len(arcs) + _piece_of(index[mine], cuts, arc.closed)
        arcs += _between(arc, cuts, len(spots))
        spots += [(float(x), float(y)) for x, y in arc.points[cuts]]
        frame += [False] * len(cuts)
        smooth += [True] * len(cuts)
    angles = [(0.0, 0.0) if a.closed else (departure(a.points), departure(a.points[::-1])) for a in arcs]
    places = np.array(spots, dtype=np.float64).reshape(-1, 2)
    return assembled(diagram.size, places, arcs, angles, np.array(frame, bool), np.array(smooth, bool)), owner


def _cuts(arc: Arc, index: Array, starts: list[int]) -> list[int]:
    """Points at which the arc is cut, ascending; a closed one has none or at least two."""
    if len(starts) < 2:
        return []
    count = len(index)
    at = sorted({int(index[first % count]) for first in (starts if arc.closed else starts[1:])})
    last = len(arc.points) - 1
    if arc.closed:
        gaps = np.diff([*at, at[0] + last])
        return at if len(at) > 1 and gaps.min() >= SHORTEST else []
    kept: list[int] = []
    for cut in at:
        if cut - (kept[-1] if kept else 0) >= SHORTEST and last - cut >= SHORTEST:
            kept.append(cut)
    return kept


def _piece_of(index: Array, cuts: list[int], closed: bool) -> Array:
    """Which piece each point lies in."""
    piece = np.searchsorted(np.array(cuts, dtype=np.int64), index, side="right")
    return np.asarray((piece - 1) % len(cuts) if closed and cuts else piece)


def _between(arc: Arc, cuts: list[int], first: int) -> list[Arc]:
    """The pieces of ``arc``; the new junctions are numbered from ``first``."""
    if not cuts:
        return [arc]
    new = list(range(first, first + len(cuts)))
    if arc.start == LOOP:
        ring = arc.points[:-1]
        around = np.concatenate([ring[cuts[0] :], ring[: cuts[0] + 1]])
        edges = [cut - cuts[0] for cut in cuts] + [len(around) - 1]
        ends, points = [*new, new[0]], around
    else:
        edges, points = [0, *cuts, len(arc.points) - 1], arc.points
        ends = [arc.start, *new, arc.end]
    return [
        replace(arc, start=a, end=b, points=read_only(points[i : j + 1].copy()))
        for a, b, i, j in zip(ends, ends[1:], edges, edges[1:], strict=False)
    ]
