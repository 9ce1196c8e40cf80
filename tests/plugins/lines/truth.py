"""What the lines and junctions of a lab scene truly are, without looking at how they were found."""

from __future__ import annotations

from math import pi, tau

import numpy as np
from scipy.ndimage import distance_transform_edt

from visint_lab.rays.shapes import Box
from visint_lines.painting import pixels_of

LIMB, OCCLUDING, CONVEX, CONCAVE, MARK = range(1, 6)
NUMBERS = {"limb": LIMB, "occluding": OCCLUDING, "convex": CONVEX, "concave": CONCAVE, "mark": MARK}
NEAR = 4.0
"""Pixels from the image of a box's corner within which two lines meet at it."""
BY_KINDS = {
    (LIMB, OCCLUDING, CONVEX): "R",
    (OCCLUDING, OCCLUDING, CONVEX): "W",
    (OCCLUDING, OCCLUDING, CONCAVE): "Y",
    (CONVEX, CONVEX, CONVEX): "Y",
    (CONCAVE, CONCAVE, CONCAVE): "Y",
    (CONVEX, CONVEX, CONCAVE): "W",
    (CONVEX, CONCAVE, CONCAVE): "W",
}
"""Three lines that meet at a corner of the scene: what they are says how they lie."""


def kinds_of(diagram, edges):
    """int (A,): what most true edge pixels near each arc are; 0 where there is none."""
    distance, nearest = distance_transform_edt(edges == 0, return_indices=True)
    label = np.where(distance <= 2.5, edges[tuple(nearest)], 0)
    found = []
    for arc in diagram.arcs:
        points = arc.points[2:-2] if len(arc.points) > 8 else arc.points
        met = label[pixels_of(points, diagram.size)]
        met = met[(met > 0) & (met < 6)]
        found.append(int(np.bincount(met).argmax()) if len(met) else 0)
    return np.array(found)


def nearer_regions(diagram, depth):
    """The region on the nearer side of the middle of each arc."""
    found = []
    for arc in diagram.arcs:
        middle = len(arc.points) // 2
        along = arc.points[min(middle + 2, len(arc.points) - 1)] - arc.points[max(middle - 2, 0)]
        across = np.array([-along[1], along[0]]) / max(np.hypot(*along), 1e-9)
        left, right = (_depth_at(arc.points[middle] + 3 * side * across, depth) for side in (-1, 1))
        found.append(arc.left if left < right else arc.right)
    return found


def _depth_at(spot, depth):
    column, row = np.clip(np.rint(spot).astype(int), 0, np.array(depth.shape)[::-1] - 1)
    return depth[row, column]


def corners_of(scene):
    """(N, 2): where the corners of the scene's boxes are in the image, seen or not."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    found = [np.empty((0, 2))]
    for thing in scene.things:
        if isinstance(thing.shape, Box):
            half = np.array([thing.shape.a, thing.shape.b, thing.shape.c])
            spots = (signs * half) @ np.asarray(thing.rotation).T + np.asarray(thing.position)
            found.append(scene.rig.rectified().left.project(spots))
    return np.concatenate(found)


def types_of(diagram, kinds, nearer, corners):
    """The type of each junction, ``""`` where it is none of the scene's (the frame, a loose end).

    Of two lines, one a limb: C. At a corner of a box, or where a concave crease ends: L. Otherwise the line
    just goes on: P. Of three, two of which belong to one surface that hides what is behind it: T; else by their
    kinds.
    """
    return [_type(junction, kinds, nearer, corners) for junction in diagram.junctions]


def _type(junction, kinds, nearer, corners):
    arcs = [spoke.arc for spoke in junction.spokes]
    if junction.frame or len(arcs) < 2:
        return ""
    met = [int(kinds[arc]) for arc in arcs]
    if len(arcs) == 2:
        return _of_two(met, np.hypot(*(corners - (junction.x, junction.y)).T).min(initial=np.inf))
    if len(arcs) > 3:
        return "M"
    hiding = [nearer[arc] for arc, kind in zip(arcs, met, strict=True) if kind in (LIMB, OCCLUDING)]
    if len(set(hiding)) < len(hiding) and sorted(met) != [LIMB, OCCLUDING, CONVEX]:
        return "T"
    gaps = [
        (b - a) % tau for a, b in zip(junction.angles, junction.angles[1:] + junction.angles[:1], strict=True)
    ]
    by_angles = "T" if LIMB in met else "W" if max(gaps) > pi else "Y"
    return BY_KINDS.get(tuple(sorted(met)), by_angles)


def _of_two(met, to_corner):
    if (met[0] == LIMB) != (met[1] == LIMB):
        return "C"
    return "L" if to_corner < NEAR or (met[0] == CONCAVE) != (met[1] == CONCAVE) else "P"
