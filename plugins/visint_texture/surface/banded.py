"""Least squares over the corners of a lattice of cells, by banded Cholesky."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["Corners", "plate"]


class Corners:
    """Normal equations of terms that are linear in the corners of R × C cells, (R+1) × (C+1) unknowns.

    ``spacing`` (dU, dV) is a cell's size.
    """

    def __init__(self, shape: tuple[int, int], spacing: tuple[float, float]) -> None:
        self.shape = (shape[0] + 1, shape[1] + 1)
        self.stride = shape[1] + 1
        count = self.shape[0] * self.stride
        self.band = np.zeros((2 * self.stride + 1, count))
        self.right = np.zeros(count)
        self._index = np.arange(count).reshape(self.shape)
        self._places = [self._index[:-1, :-1], self._index[:-1, 1:], self._index[1:, :-1], self._index[1:, 1:]]
        across, down = 0.5 / spacing[0], 0.5 / spacing[1]
        self._mean = np.full(4, 0.25)
        self._across = np.array([-across, across, -across, across])
        self._down = np.array([-down, -down, down, down])

    def at_cells(self, corners: Array) -> tuple[Array, Array, Array]:
        """Value and slopes (R, C) at the cells of a field (R+1, C+1) at the corners."""
        taken = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, :-1], corners[1:, 1:]], axis=-1)
        return taken @ self._mean, taken @ self._across, taken @ self._down

    def add(self, value: Array, across: Array, down: Array, wanted: Array, weight: Array) -> None:
        """Terms weight · (value·w + across·w_U + down·w_V − wanted)², each (R, C)."""
        factors = [
            value * m + across * a + down * d
            for m, a, d in zip(self._mean, self._across, self._down, strict=True)
        ]
        for k in range(4):
            held = weight * factors[k]
            self.right[self._places[k]] += held * wanted
            for other in range(k, 4):
                offset = int(self._places[other][0, 0] - self._places[k][0, 0])
                self.band[offset][self._places[k]] += held * factors[other]

    def solved(self) -> Array:
        """The field (R+1, C+1) that fits best."""
        from scipy.linalg import solveh_banded

        self.band[0] += 1e-9 * self.band[0].max()
        field = solveh_banded(self.band, self.right, lower=True, check_finite=False)
        return np.asarray(field).reshape(self.shape)


def plate(shape: tuple[int, int]) -> Array:
    """The band (2(C+1)+1, (R+1)(C+1)) of Σ (∂²w)² over the corners of R × C cells, in steps of the lattice."""
    rows, columns = shape[0] + 1, shape[1] + 1
    band = np.zeros((2 * columns + 1, rows * columns))
    index = np.arange(rows * columns).reshape(rows, columns)
    _add_stencil(band, [index[:, :-2], index[:, 1:-1], index[:, 2:]], (1, -2, 1))
    _add_stencil(band, [index[:-2], index[1:-1], index[2:]], (1, -2, 1))
    root = np.sqrt(2)
    corners = [index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]]
    _add_stencil(band, corners, (root, -root, -root, root))
    return band


def _add_stencil(band: Array, places: list[Array], factors: tuple[float, ...]) -> None:
    if not places[0].size:
        return
    for k, one in enumerate(factors):
        for other in range(k, len(factors)):
            offset = int(places[other].flat[0] - places[k].flat[0])
            band[offset][places[k]] += one * factors[other]
