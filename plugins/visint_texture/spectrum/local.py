"""Local moments, and what tells whether they are a texture's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array

__all__ = ["LocalMoments"]


@dataclass(frozen=True, slots=True)
class LocalMoments:
    """Moments on a lattice, and what they were measured from; float32 throughout.

    ``moments`` (R, C, 3), (cycles/px)²; ``energy`` (R, C), squared contrast; ``evenness`` (R, C) in [0, 1]:
    1 where contrast fills the window, small where a lone edge makes it; ``whiteness`` (R, C) in
    [0, 1]: 1 for noise, small where some band stands out.
    """

    moments: Array
    energy: Array
    evenness: Array
    whiteness: Array

    def texture(self, longest: float) -> Array:
        """float32 (R, C) in [0, 1]: is this a texture?

        Not where there is no contrast, where the spectrum is that of noise, where a lone edge makes it, or
        where the waves are nearly as long as the ``longest`` (px) of the bank: such is shading.
        """
        spread = self.moments[..., 0] + self.moments[..., 2]
        waves = np.sqrt(np.maximum(spread, 0)) * np.float32(longest)
        contrast = np.sqrt(np.maximum(self.energy, 0))
        gates = (
            _rising(contrast, 0.03, 0.08),
            1 - _rising(self.whiteness, 0.15, 0.4),
            _rising(self.evenness, 0.55, 0.8),
            _rising(waves, 1.3, 1.8),
        )
        return np.asarray(np.multiply.reduce(gates), dtype=np.float32)


def _rising(value: Array, none: float, full: float) -> Array:
    """0 up to ``none``, 1 from ``full``, straight between."""
    return np.clip((value - none) / (full - none), 0, 1)
