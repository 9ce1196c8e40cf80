"""The cost volume: census distances, and their sums over the eight paths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visint.arrays import Array

__all__ = ["Levels", "Penalties", "Volume", "census", "matching_costs", "path_costs"]

Check = Callable[[], None]


@dataclass(frozen=True, slots=True)
class Levels:
    """The disparities searched: ``first``, first + 1, …, ``count`` of them, in pixels.

    ``base`` int32 (H, W), not negative, moves a pixel's levels up: a band around what is known of it.
    """

    first: int
    count: int
    base: Array | None = None

    def lowest(self, shape: tuple[int, int]) -> Array:
        """The base of each pixel, int32 (H, W): zeros unless there is one."""
        return np.zeros(shape, dtype=np.int32) if self.base is None else self.base

    def searched(self, disparity: Array) -> Array:
        """Bool (H, W): where ``disparity`` lies strictly between the ends of what was searched."""
        low = self.first + self.lowest(disparity.shape)
        return np.asarray((disparity > low) & (disparity < low + self.count - 1))

    @property
    def last(self) -> int:
        """The largest disparity searched."""
        return self.first + self.count - 1


@dataclass(frozen=True, slots=True)
class Penalties:
    """What a jump of the disparity costs, in census bits (of 62).

    Parameters
    ----------
    small
        P1, a step by one level. More favours fronto-parallel surfaces.
    large
        P2, any larger jump: (at a strong edge, on an even surface). At most (…, 100): costs are bytes.
    edge
        Brightness step in 8-bit grades that divides the extra penalty by e.
    outside
        Cost of a match outside the other image: neutral at about 30 % of the most.
    """

    small: int = 16
    large: tuple[int, int] = (24, 100)
    edge: float = 20.0
    outside: int = 18

    def steep(self) -> Array:
        """P2 by brightness step in 8-bit grades, uint8 (256,)."""
        low, high = self.large
        costs = low + (high - low) * np.exp(-np.arange(256) / self.edge)
        return np.asarray(np.rint(costs), dtype=np.uint8)


@dataclass(frozen=True, slots=True)
class Volume:
    """Path costs of every pixel and level: ``total`` uint16 (H, W, D)."""

    levels: Levels
    total: Array


def census(grades: Array) -> Array:
    """uint64 (H, W): which of 62 neighbours in 9×7 are darker than the pixel. grades uint16 (H, W)."""
    from visint_stereo.semiglobal import _kernels

    words = np.empty(grades.shape, dtype=np.uint64)
    _kernels.census(np.pad(grades, ((3, 3), (4, 4)), mode="edge"), words)
    return words


def matching_costs(left: Array, right: Array, levels: Levels, outside: int) -> Array:
    """uint8 (H, W, D): census bits in which left pixel x and right pixel x - d differ."""
    from visint_stereo.semiglobal import _kernels

    cost = np.empty((*left.shape, levels.count), dtype=np.uint8)
    mirrored = np.ascontiguousarray(right[:, ::-1])
    _kernels.hamming(left, mirrored, levels.first, levels.lowest(left.shape), np.uint8(outside), cost)
    return cost


def path_costs(cost: Array, levels: Levels, grades: Array, penalties: Penalties, check: Check) -> Array:
    """uint16 (H, W, D): ``cost`` summed along eight paths.

    Semi-global matching (Hirschmüller 2008, doi:10.1109/TPAMI.2007.1166, Eq. 13), its large penalty falling
    with the brightness step between neighbours.
    """
    from visint_stereo.semiglobal import _kernels

    total = np.zeros(cost.size, dtype=np.uint16)
    base = levels.lowest(grades.shape)
    pad = 0 if levels.base is None else levels.count
    brightness = (grades >> 4).astype(np.uint8)
    prices = (brightness, np.uint8(penalties.small), penalties.steep())
    for way in (1, -1):
        _kernels.aggregate(cost.reshape(-1), cost.shape, base, pad, *prices, total, way)
        check()
    return total.reshape(cost.shape)
