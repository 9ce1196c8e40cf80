"""How noisy an image is."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["noise_of"]


def noise_of(image: Array) -> float:
    """Standard deviation of white noise in ``image`` float32 (H, W), in its own unit.

    The median response to a mask blind to planes and to edges along the axes (Immerkær 1996,
    doi:10.1006/cviu.1996.0060). What is clipped at 0 or 1, or unknown, tells nothing; 0 if nothing is left.
    """
    from visint_shading import _kernels

    if min(image.shape) < 3:
        return 0.0
    response = np.empty(image.size, np.float32)
    count = _kernels.fine_responses(image, response)
    return float(np.median(response[:count], overwrite_input=True) / (0.6745 * 6)) if count else 0.0
