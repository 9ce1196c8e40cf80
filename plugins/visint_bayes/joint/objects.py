"""A pair that shows objects before a void, ready for the energy."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint_bayes.joint.outline import LOST, outlined, unmatched
from visint_bayes.joint.setting import Pair

__all__ = ["pair_of"]


def pair_of(images: tuple[Array, Array], matched: Array, camera: Camera, light: Light | None) -> Pair | None:
    """The pair of two images with the left view's matched disparity; None where there is no void."""
    from visint_bayes.joint.void import foreground

    inside, inside_right = (foreground(image) for image in images)
    if inside is None or inside_right is None or not np.isfinite(matched).any():
        return None
    stereo = np.nan_to_num(matched, nan=float(np.nanmedian(matched))).astype(np.float32)
    if unmatched(stereo, inside, inside_right) > LOST:
        stereo = np.where(inside, outlined(inside, inside_right), stereo)
    there = _seen_from_the_right(stereo, inside)
    return Pair(*images, inside, inside_right, stereo, there, camera, light)


def _seen_from_the_right(stereo: Array, inside: Array) -> Array:
    """The right view's disparity that the left one implies, complete."""
    from scipy.ndimage import distance_transform_edt

    from visint_bayes.joint.matching import _kernels

    there = np.empty_like(stereo)
    _kernels.nearest_there(stereo, inside, there)
    unknown = ~np.isfinite(there)
    if unknown.all():
        return np.zeros_like(stereo)
    nearest = distance_transform_edt(unknown, return_distances=False, return_indices=True)
    return np.ascontiguousarray(there[tuple(nearest)])
