"""Curves in the image: smoothed, spaced evenly, and the direction in which each leaves a junction."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["departure", "evenly", "smoothed"]

SKIP = 3.0
"""Pixels next to a junction that say nothing of the direction: smoothing and snapping bend them."""
STRAIGHT = 16.0
"""Pixels that a straight line is fitted to."""
BENT = 30.0
"""Pixels that a parabola is fitted to where the line bends: shorter ones are too unsure of their end."""
SAG = 0.03
"""How far a curve may leave its chord, in parts of its length, and still be straight."""


def smoothed(points: Array, sigma: float, closed: bool) -> Array:
    """``points`` (N, 2) after a Gaussian along the curve; ends stay where they are."""
    reach = min(int(3 * sigma + 1), len(points) - 1)
    if reach < 1 or sigma <= 0:
        return points
    if closed:
        ring = points[:-1]
        reach = min(reach, len(ring))
        wide = np.concatenate([ring[-reach:], ring, ring[:reach]])
    else:
        before, after = 2 * points[0] - points[reach:0:-1], 2 * points[-1] - points[-2 : -reach - 2 : -1]
        wide = np.concatenate([before, points, after])
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    weight /= weight.sum()
    even = np.stack([np.convolve(wide[:, i], weight, mode="valid") for i in (0, 1)], axis=-1)
    return np.concatenate([even, even[:1]]) if closed else even


def evenly(points: Array, step: float = 1.0) -> Array:
    """``points`` (N, 2) at about equal distances of ``step`` along the curve, both ends kept."""
    along = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
    count = max(round(float(along[-1]) / step), 1) + 1
    at = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(at, along, points[:, i]) for i in (0, 1)], axis=-1)


def departure(points: Array) -> float:
    """The direction in which the curve leaves its first point, radians, y up.

    The main axis of the points a little away from the junction; where they bend, the tangent at the junction of
    a parabola through more of them.
    """
    away = np.hypot(*(points - points[0]).T)
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    skip = min(SKIP, 0.25 * length)
    near = points[(away >= skip) & (away <= skip + STRAIGHT)][: int(2 * (skip + STRAIGHT))]
    if len(near) < 3:
        return _angle(points[-1] - points[0])
    wide = points[: int(BENT) + 1]
    if length >= 20 and _sag(wide) > SAG:
        return _angle(_parabola(wide[int(skip) :]))
    return _angle(_axis(near))


def _sag(points: Array) -> float:
    chord = points[-1] - points[0]
    length = float(np.hypot(*chord))
    if length == 0:
        return np.inf
    off = (points - points[0]) @ np.array([-chord[1], chord[0]]) / length
    return float(np.abs(off).max() / length)


def _axis(points: Array) -> Array:
    centred = points - points.mean(axis=0)
    _, vectors = np.linalg.eigh(centred.T @ centred)
    axis = vectors[:, -1]
    return np.asarray(axis if (points[-1] - points[0]) @ axis >= 0 else -axis)


def _parabola(points: Array) -> Array:
    """The tangent, where the arc began, of parabolas x(t), y(t) through points a pixel apart."""
    t = np.arange(len(points)) + SKIP
    terms = np.stack([np.ones_like(t), t, t * t], axis=-1)
    return np.asarray(np.linalg.lstsq(terms, points, rcond=None)[0][1])


def _angle(direction: Array) -> float:
    return float(np.arctan2(-direction[1], direction[0]))
