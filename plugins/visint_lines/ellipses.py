"""How well an ellipse explains a piece of curve: a rim seen at a low angle turns sharply and has no corner."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["off_ellipse", "off_line"]


def off_line(points: Array) -> float:
    """Sum of the squared distances of points (N, 2) from the line through them, pixels²."""
    if len(points) < 3:
        return 0.0
    return float(np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[-1] ** 2)


def off_ellipse(points: Array) -> float:
    """Root mean square distance, pixels and to first order, of points (N, 2) from the ellipse that fits them.

    The direct fit of Fitzgibbon et al. (1999, DOI 10.1109/34.765658) in the stable form of Halíř and Flusser:
    the least algebraic error among ellipses, never a pair of lines. A point counts at most five pixels.
    """
    middle = points.mean(axis=0)
    size = max(float(np.abs(points - middle).max()), 1e-9)
    x, y = ((points - middle) / size).T
    a, b, c, d, e, f = _conic(x, y)
    value = a * x * x + b * x * y + c * y * y + d * x + e * y + f
    steep = np.hypot(2 * a * x + b * y + d, b * x + 2 * c * y + e)
    distance = np.minimum(size * np.abs(value) / np.maximum(steep, 1e-9), 5.0)
    return float(np.sqrt(np.mean(distance**2)))


def _conic(x: Array, y: Array) -> Array:
    """(6,): coefficients of x², xy, y², x, y, 1 of the ellipse through points."""
    square, linear = np.stack([x * x, x * y, y * y], axis=-1), np.stack([x, y, np.ones_like(x)], axis=-1)
    mixed = square.T @ linear
    back = -np.linalg.pinv(linear.T @ linear) @ mixed.T
    scatter = square.T @ square + mixed @ back
    reduced = np.stack([scatter[2] / 2, -scatter[1], scatter[0] / 2])
    vectors = np.real(np.linalg.eig(reduced)[1])
    roundness = 4 * vectors[0] * vectors[2] - vectors[1] ** 2  # positive for an ellipse alone
    best = vectors[:, int(roundness.argmax())]
    return np.concatenate([best, back @ best])
