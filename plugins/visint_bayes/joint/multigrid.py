"""The solver: conjugate gradients preconditioned by a Galerkin multigrid that interpolates across no cut."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visint.arrays import Array

__all__ = ["Multigrid"]

SMALLEST = 8
"""Coarsening stops at this side, cells; there the matrix is inverted directly."""


@dataclass(frozen=True, slots=True)
class _Level:
    """One level's matrix with a margin of two, (H + 4, W + 4, 13 or 25), and how the next is interpolated."""

    matrix: Array
    weights: Array | None

    @property
    def size(self) -> tuple[int, int]:
        """(rows, columns), margin included."""
        return self.matrix.shape[0], self.matrix.shape[1]

    def times(self, field: Array) -> Array:
        """matrix · field."""
        from visint_bayes.joint import _kernels

        out = np.zeros_like(field)
        (_kernels.times_diamond if self.matrix.shape[2] == 13 else _kernels.times)(self.matrix, field, out)
        return out

    def relax(self, wanted: Array, field: Array, backwards: bool) -> None:
        """Two Gauss-Seidel sweeps of ``field`` in place."""
        from visint_bayes.joint import _kernels

        sweep = _kernels.relax_diamond if self.matrix.shape[2] == 13 else _kernels.relax
        for _ in range(2):
            sweep(self.matrix, wanted, field, backwards)


class Multigrid:
    """A symmetric positive definite 5x5-stencil matrix, ready to be solved with.

    Cell-centred coarsening by two; a coarse cell belongs to the piece most of its pixels belong to, and a pixel
    is interpolated from cells of its own piece only. The coarse matrices are Pᵀ A P, so they know of every cut
    that the fine one has, and the whole is linear in pixels in time and memory.

    Reference: W. L. Briggs, V. E. Henson and S. F. McCormick, A Multigrid Tutorial, 2000, chapters 3 and 10,
    doi:10.1137/1.9780898719505.
    """

    def __init__(self, matrix: Array, pieces: Array) -> None:
        """``matrix`` float32 (H, W, 25); ``pieces`` int32 (H, W), 0 outside the domain."""
        self._levels = _levels(matrix, pieces)
        self._bottom = _inverse(self._levels[-1])

    def solve(self, wanted: Array, tolerance: float = 1e-3, most: int = 30) -> Array:
        """x of A x = ``wanted``, float64 (H, W), to a residual below ``tolerance`` of the right side's norm."""
        right = np.pad(wanted.astype(np.float64), 2)
        found = _conjugate_gradients(self._levels[0].times, self.cycle, right, (tolerance, most))
        return np.ascontiguousarray(found[2:-2, 2:-2])

    def cycle(self, wanted: Array, level: int = 0) -> Array:
        """One V-cycle from zero: a symmetric approximation of the inverse; arrays with a margin of two."""
        from visint_bayes.joint import _kernels

        here = self._levels[level]
        field = np.zeros_like(wanted)
        if here.weights is None:
            inner = wanted[2:-2, 2:-2]
            field[2:-2, 2:-2] = (self._bottom @ inner.ravel()).reshape(inner.shape)
            return field
        here.relax(wanted, field, False)
        coarse = np.zeros(self._levels[level + 1].size)
        _kernels.restricted(wanted - here.times(field), here.weights, coarse)
        _kernels.add_prolonged(self.cycle(coarse, level + 1), here.weights, field)
        here.relax(wanted, field, True)
        return field


def _levels(matrix: Array, pieces: Array) -> list[_Level]:
    from visint_bayes.joint import _kernels

    found: list[_Level] = []
    while max(matrix.shape[:2]) > SMALLEST:
        size = tuple((side + 1) // 2 for side in matrix.shape[:2])
        coarse = np.zeros(size, np.int32)
        _kernels.coarse_pieces(pieces, coarse)
        weights = np.empty((*matrix.shape[:2], 4), np.float32)
        _kernels.interpolation(pieces, coarse, weights)
        found.append(_Level(_diamond(matrix) if not found else _with_margin(matrix), weights))
        smaller = np.zeros((*size, 25), np.float32)
        _kernels.galerkin(matrix, weights, smaller)
        matrix, pieces = smaller, coarse
    return [*found, _Level(_with_margin(matrix), None)]


def _with_margin(matrix: Array) -> Array:
    return np.pad(matrix, ((2, 2), (2, 2), (0, 0)))


def _diamond(matrix: Array) -> Array:
    """The finest matrix without the couplings that the energy does not have."""
    from visint_bayes.joint import _kernels

    height, width = matrix.shape[:2]
    out = np.zeros((height + 4, width + 4, 13), np.float32)
    _kernels.packed(matrix, out)
    return out


def _inverse(level: _Level) -> Array:
    """The pseudo-inverse of a small matrix, (N, N)."""
    size = level.size[0] - 4, level.size[1] - 4
    count = size[0] * size[1]
    dense = np.empty((count, count))
    for place in range(count):
        unit = np.zeros(count)
        unit[place] = 1
        dense[:, place] = level.times(np.pad(unit.reshape(size), 2))[2:-2, 2:-2].ravel()
    return np.asarray(np.linalg.pinv((dense + dense.T) / 2, rcond=1e-7, hermitian=True))


def _conjugate_gradients(
    product: Callable[[Array], Array],
    cycle: Callable[[Array], Array],
    wanted: Array,
    stop: tuple[float, int],
) -> Array:
    tolerance, most = stop
    field, left = np.zeros_like(wanted), wanted
    enough = tolerance * float(np.linalg.norm(wanted))
    way, before = np.zeros_like(wanted), 1.0
    for _ in range(most):
        if float(np.linalg.norm(left)) <= enough:
            break
        better = cycle(left)
        now = float(np.vdot(left, better))
        way = better + (now / before) * way
        along = product(way)
        step = now / float(np.vdot(way, along))
        field, left, before = field + step * way, left - step * along, now
    return field
