"""Chances as log odds: what logistic models add up."""

from __future__ import annotations

from typing import Literal

import numpy as np

from visint.arrays import Array

__all__ = ["TrainedOn", "chance", "log_odds"]

TrainedOn = Literal["all", "A", "B"]


def log_odds(reliability: Array) -> Array:
    """float32: log p/(1 - p), p kept within 1 % of the ends."""
    kept = np.clip(reliability, 0.01, 0.99)
    return np.asarray(np.log(kept / (1 - kept)), dtype=np.float32)


def chance(signs: Array, weights: tuple[float, ...], bias: float) -> Array:
    """float32 (H, W) in (0, 1) from signs (N, H, W)."""
    odds = np.tensordot(np.asarray(weights, np.float32), signs, axes=1) + np.float32(bias)
    return np.asarray(1 / (1 + np.exp(-odds)), dtype=np.float32)
