"""Second moments of the local spectrum by the structure tensor."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_texture.spectrum.contrast import local_mean
from visint_texture.spectrum.filling import filling
from visint_texture.spectrum.local import LocalMoments

__all__ = ["tensor_moments"]


def tensor_moments(image: Array, window: float, blur: float, step: int) -> LocalMoments:
    """Moments (g_x, 2E[u_x u_y], g_y) of contrast ``image`` (H, W) one sample every ``step`` px.

    By Parseval, the mean of ∇I∇Iᵀ over that of I² is (2π)² times the mean of u uᵀ. Fast, and exact for
    smooth textures; where edges are sharp it follows the image's blur (``blur``, px) more than the texture.
    """
    import cv2

    shape = (max(1, -(-image.shape[0] // step)), max(1, -(-image.shape[1] // step)))
    smooth = cv2.GaussianBlur(image, (0, 0), blur) if blur > 0 else image
    across = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, ksize=3, scale=1 / 8, borderType=cv2.BORDER_REFLECT)
    down = cv2.Sobel(smooth, cv2.CV_32F, 0, 1, ksize=3, scale=1 / 8, borderType=cv2.BORDER_REFLECT)
    energy = smooth * smooth
    layers = (across * across, 2 * across * down, down * down, energy)
    means = [_on(shape, local_mean(layer, window)) for layer in layers]
    even = _on(shape, filling(image, window))
    total = np.maximum(means[3], np.float32(1e-20))
    moments = np.stack(means[:3], axis=-1) / (np.float32(4 * np.pi**2) * total[..., None])
    # The mean frequency of white noise blurred so is 1 / (2π blur √2) along either axis.
    mean = (moments[..., 0] + moments[..., 2]) / 2
    whiteness = mean * np.float32(8 * np.pi**2 * max(blur, 0.5) ** 2)
    return LocalMoments(moments, means[3], even, np.minimum(1, whiteness).astype(np.float32))


def _on(shape: tuple[int, int], field: Array) -> Array:
    import cv2

    coarse: Array = cv2.resize(field, shape[::-1], interpolation=cv2.INTER_AREA)
    return coarse
