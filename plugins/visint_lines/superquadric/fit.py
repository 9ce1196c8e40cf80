"""Fitting a superquadric to points of one side of a body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_lines.superquadric.shape import ROUNDEST, SQUAREST, Superquadric, misfit, rotation_of

__all__ = ["Fit", "fitted"]

MOST, FEW = 600, 200
"""Points that take part at last, and in the first try of every start; more cost time and say nothing new."""
LONG, SHORT = 60, 15
"""Steps of the two."""
SMALLEST = 1e-3
"""Of its points' extent, the least half-axis."""
SILENT = 0.04
"""How strongly rays that miss the body repel it, beside a point on it."""


class Fit(NamedTuple):
    """A superquadric and its root mean square distance from the points."""

    shape: Superquadric
    rms: float


def fitted(points: Array, outline: Array) -> Fit | None:
    """The superquadric nearest to visible points, smallest among those that fit alike.

    Half of every body is hidden: its size along the line of sight follows from symmetry alone, and the
    outline holds it. Several starts (the axes of inertia in turn for its own z) end in one best fit by
    Levenberg and Marquardt's way (Solina and Bajcsy 1990, DOI 10.1109/34.44401).

    Parameters
    ----------
    points
        (N, 3), in the camera's frame.
    outline
        (M, 3): unit rays that pass the body closely and do not meet it; none where others cover its outline.

    Returns
    -------
    None where fewer than 30 points are known, or they lie on a line.
    """
    if len(points) < 30:
        return None
    chosen = _some(points, MOST)
    scale = float(np.linalg.norm(chosen.std(axis=0)))
    if not scale > 0:
        return None
    few, rays = _some(points, FEW), _some(outline, FEW // 4)
    tried = [_descended(start, few, rays, scale, SHORT) for start in _starts(chosen, scale)]
    hopeful = [shape for _, shape in sorted(tried, key=lambda one: one[0])[:2]]
    found = [_descended(shape, chosen, outline, scale, LONG) for shape in hopeful]
    cost, best = min(found, key=lambda one: one[0])
    if not np.isfinite(cost):
        return None
    return Fit(best, float(np.sqrt(np.mean(misfit(best, chosen) ** 2))))


def _some(points: Array, most: int) -> Array:
    few = np.linspace(0, len(points) - 1, min(most, len(points))).astype(int)
    return np.asarray(points[few])


def _starts(points: Array, scale: float) -> list[Superquadric]:
    """Ellipsoids about the points, each axis of inertia once as the own z; centres behind what is seen."""
    centre = points.mean(axis=0)
    _, axes = np.linalg.eigh(np.cov((points - centre).T))
    sight = centre / np.linalg.norm(centre)
    half = np.maximum(np.ptp((points - centre) @ axes, axis=0) / 2, 0.2 * scale)
    starts = []
    for last in range(3):
        order = [(last + 1) % 3, (last + 2) % 3, last]
        frame = axes[:, order]
        frame[:, 0] *= np.sign(np.linalg.det(frame))
        place = centre + 0.6 * float(np.median(half)) * sight
        size = np.maximum(half[order], 0.5 * float(np.median(half)))
        starts += [_made(size, bent, _vector_of(frame), place) for bent in ((1.0, 1.0), (0.3, 1.0))]
    return starts


def _made(size: Array, roundness: tuple[float, float], turn: Array, place: Array) -> Superquadric:
    a, b, c = map(float, size)
    u, v, w = map(float, turn)
    x, y, z = map(float, place)
    return Superquadric((a, b, c), roundness, (u, v, w), (x, y, z))


def _vector_of(matrix: Array) -> Array:
    """The rotation vector of a rotation (3, 3)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(matrix).as_rotvec())


def _descended(
    start: Superquadric, points: Array, outline: Array, scale: float, steps: int
) -> tuple[float, Superquadric]:
    from scipy.optimize import least_squares

    low = np.array([np.log(SMALLEST * scale)] * 3 + [SQUAREST] * 2 + [-10.0] * 3 + [-np.inf] * 3)
    high = np.array([np.log(20 * scale)] * 3 + [ROUNDEST, ROUNDEST] + [10.0] * 3 + [np.inf] * 3)
    weight = 1 / (scale * len(points) ** 0.5)
    pull = SILENT / max(len(outline), 1) ** 0.5 / scale

    def residual(vector: Array) -> Array:
        shape = Superquadric.of(vector)
        on = misfit(shape, points) * weight
        if not len(outline):
            return np.concatenate([on, 1e-3 * vector[:3]])
        return np.concatenate([on, 1e-4 * vector[:3], pull * _intrusion(shape, outline)])

    first = np.clip(start.vector(), low + 1e-6, high - 1e-6)
    try:
        told = least_squares(residual, first, bounds=(low, high), max_nfev=steps, x_scale="jac")
    except ValueError:  # a residual overflowed far from any fit
        return float("inf"), start
    return float(told.cost), Superquadric.of(told.x)


def _intrusion(shape: Superquadric, rays: Array) -> Array:
    """(M,): how deep each ray runs inside the body, 0 where it passes by, at its own nearest point."""
    frame = rotation_of(np.asarray(shape.turn)) / np.asarray(shape.size)
    centre, way = np.asarray(shape.place) @ frame, rays @ frame
    along = (way @ centre) / np.maximum((way**2).sum(axis=1), 1e-12)
    nearest = rays * along[:, None]
    return np.minimum(misfit(shape, nearest), 0.0)
