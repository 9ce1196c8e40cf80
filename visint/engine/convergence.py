"""Convergence: how much a value changed in a turn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from visint.fields.evidence import Evidence

__all__ = ["relative_change"]


def relative_change(before: Any, after: Any) -> float:
    """Relative rms change: ‖after − before‖ / ‖after‖ over the pixels finite in both.

    Parameters
    ----------
    before, after
        Numbers, flags, arrays of one shape or evidence (whose value counts); None where there is nothing.

    Returns
    -------
    0 where nothing changed, inf where all went to zero, NaN where nothing can be compared: no pixel is
    known in both, sizes differ, or what goes round is no number.
    """
    if before is None or after is None:
        return math.nan
    try:
        old, new = _numbers(before), _numbers(after)
    except (TypeError, ValueError):  # a camera, a text
        return math.nan
    if old.shape != new.shape:
        return math.nan
    both = np.isfinite(old) & np.isfinite(new)
    if not both.any():
        return math.nan
    moved = float(np.sqrt(np.mean((new[both] - old[both]) ** 2)))
    length = float(np.sqrt(np.mean(new[both] ** 2)))
    if moved == 0.0:
        return 0.0
    return moved / length if length > 0 else math.inf


def _numbers(value: Any) -> Any:
    value = value.value if isinstance(value, Evidence) else value
    return np.asarray(value, dtype=np.float64)
