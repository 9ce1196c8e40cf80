"""The cost volume: census distances, and their sums over the eight paths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visint.arrays import Array
from visint.fields.resampling import block_mean

__all__ = ["Levels", "Penalties", "Prior", "Volume", "census", "lean_on", "matching_costs", "path_costs"]

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
class Prior:
    """A surface to follow: ``value`` float32 (H, W), px; ``weight`` float32 (H, W) in [0, 1].

    Where it is known (``there``, bool) paths climb with it at no cost; its weight times 4 bits a px, at most
    12, is what a level costs that lies off it.
    """

    value: Array
    weight: Array
    there: Array

    @classmethod
    def of(cls, value: Array, weight: Array) -> Prior:
        """From a surface that is NaN where unknown, float32 (H, W), and its weight."""
        there = np.isfinite(value)
        return cls(np.where(there, value, np.float32(0)), weight, there)

    def rows(self, part: slice) -> Prior:
        """Its rows of a strip."""
        return Prior(self.value[part], self.weight[part], self.there[part])

    def halved(self) -> Prior:
        """At half the size, in pixels of that size; unknown where any of the four is."""
        value = np.where(self.there, self.value, np.float32(np.nan))
        return Prior.of(block_mean(value) / 2, block_mean(self.weight))

    def lean(self) -> Array:
        """int32 (H, W): whole levels of the surface; far off where there is none: nothing follows it there."""
        lost = np.int32(-(1 << 20))
        return np.where(self.there, np.rint(self.value).astype(np.int32), lost)


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


def lean_on(cost: Array, prior: Prior, levels: Levels) -> None:
    """Adds to ``cost`` what each level costs for lying off the prior; in place."""
    from visint_stereo.semiglobal import _kernels

    weight = np.where(prior.there, prior.weight, np.float32(0)).astype(np.float32)
    _kernels.lean_on(cost, prior.value, weight, levels.first, levels.lowest(cost.shape[:2]))


def path_costs(
    cost: Array,
    levels: Levels,
    grades: Array,
    penalties: Penalties,
    check: Check,
    prior: Prior | None = None,
) -> Array:
    """uint16 (H, W, D): ``cost`` summed along eight paths, which climb with the ``prior``.

    Semi-global matching (Hirschmüller 2008, doi:10.1109/TPAMI.2007.1166, Eq. 13), its large penalty falling
    with the brightness step between neighbours.
    """
    from visint_stereo.semiglobal import _kernels

    total = np.zeros(cost.size, dtype=np.uint16)
    base = levels.lowest(grades.shape)
    lean = np.zeros(grades.shape, np.int32) if prior is None else prior.lean()
    pad = levels.count if levels.base is not None else 0 if prior is None else 2
    brightness = (grades >> 4).astype(np.uint8)
    prices = (brightness, np.uint8(penalties.small), penalties.steep())
    for way in (1, -1):
        _kernels.aggregate(cost.reshape(-1), cost.shape, base, lean, pad, *prices, total, way)
        check()
    return total.reshape(cost.shape)
