"""Regions of the truth: one label a visible smooth patch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visint_lab.render.probing import Sight

__all__ = ["smooth_regions"]


def smooth_regions(sight: Sight) -> NDArray[np.int32]:
    """int32 (H, W): labels from 1, one for each face of each thing and one for the background."""
    span = int(sight.face.max()) + 2
    faces = np.where(sight.thing < 0, -1, sight.thing * span + sight.face)
    _, labels = np.unique(faces, return_inverse=True)
    return (labels.reshape(faces.shape) + 1).astype(np.int32)
