"""Which pixels count."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visint.arrays import Array
from visint.fields.evidence import known

__all__ = ["counted", "mean", "share"]


def counted(truth: Array, mask: Array | None) -> NDArray[np.bool_]:
    """Bool (H, W): pixels whose truth is known, within ``mask`` if there is one."""
    there = known(truth)
    return there if mask is None else there & mask


def mean(values: Array) -> float:
    """The mean in float64, NaN of nothing."""
    return float(np.mean(values, dtype=np.float64)) if values.size else float("nan")


def share(part: Array, whole: Array) -> float:
    """How much of ``whole`` is also ``part`` (bool), NaN of nothing."""
    return mean(part[whole])
