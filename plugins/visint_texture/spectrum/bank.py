"""The bank: where its Gabor filters stand in the plane of frequencies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array

__all__ = ["Bank", "Channel"]


@dataclass(frozen=True, slots=True)
class Channel:
    """One filter: its centre (cycles a pixel, along columns and rows) and the spread of its Gaussian."""

    across: float
    down: float
    spread: float

    @property
    def frequency(self) -> float:
        """Distance of the centre from zero."""
        return float(np.hypot(self.across, self.down))


@dataclass(frozen=True, slots=True)
class Bank:
    """Gabor filters in rings, each of the same shape relative to its own frequency.

    Parameters
    ----------
    lowest, highest
        Frequencies of the first and last ring, cycles a pixel.
    rings, orientations
        How many; orientations cover a half-turn, since images are real.
    bandwidth
        Spread of each Gaussian over its frequency.
    """

    lowest: float
    highest: float
    rings: int = 8
    orientations: int = 6
    bandwidth: float = 0.28

    @property
    def frequencies(self) -> Array:
        """float64 (rings,): the rings' frequencies, evenly apart in octaves."""
        return np.geomspace(self.lowest, self.highest, self.rings)

    def ring_list(self) -> list[list[Channel]]:
        """All filters, ring by ring, the lowest first."""
        angles = np.pi * np.arange(self.orientations) / self.orientations
        return [
            [Channel(float(f * np.cos(t)), float(f * np.sin(t)), float(f * self.bandwidth)) for t in angles]
            for f in self.frequencies
        ]
