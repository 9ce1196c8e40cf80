"""Basins: the image as many small patches that no contrast divides, and what is known of their borders."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from visint.arrays import Array

__all__ = ["along", "basins", "steps", "taps"]

LIFT = 4.0
"""Grey levels a pixel by which a line of a segmentation raises the gradient, so that basins end there."""


def basins(levels: Array, noise: float, lines: Iterable[Array]) -> tuple[Array, int]:
    """(int32 (H, W) from 0, how many): watersheds of the gradient, raised along ``lines`` (bool (H, W)).

    L. Vincent and P. Soille, Watersheds in digital spaces, PAMI 13(6), 1991, doi:10.1109/34.87344.
    The gradient is smoothed the more the noisier the image.
    """
    import cv2

    from visint_grouping import _kernels

    smooth = cv2.GaussianBlur(levels, (0, 0), float(np.clip(0.8 + noise / 18, 1.0, 2.2)))
    across, down = (cv2.Sobel(smooth, cv2.CV_32F, *axes, scale=1 / 8) for axes in ((1, 0), (0, 1)))
    height = cv2.magnitude(across, down)
    for line in lines:
        height = cv2.scaleAdd(cv2.GaussianBlur(line.astype(np.float32), (0, 0), 1.0), LIFT, height)
    quantised = np.clip(200 * height, 0, 65535).astype(np.uint16)
    labels = np.zeros(levels.shape, np.int32)
    count = _kernels.flood(np.argsort(quantised, axis=None, kind="stable"), quantised, labels)
    return labels - 1, count


def taps(length: int, *, sloped: bool) -> Array:
    """float32 (2 · length): weights of the pixels across a crack whose sum is the step of brightness there.

    Means of ``length`` pixels a side; ``sloped``: lines fitted to them and continued to the crack, so that a
    steady shade is no step.
    """
    if not sloped:
        side = np.full(length, 1 / length)
    else:
        distance = np.arange(length) + 0.5
        side = np.linalg.pinv(np.stack([np.ones(length), distance], axis=1))[0]
    return np.concatenate([-side[::-1], side]).astype(np.float32)


def steps(levels: Array, weights: Array) -> tuple[Array, Array]:
    """Steps of ``levels`` (float32 (H, W)) across cracks: (H, W - 1) to the right, (H - 1, W) downwards."""
    import cv2

    middle = len(weights) // 2 - 1
    border = cv2.BORDER_REPLICATE
    right = cv2.filter2D(levels, cv2.CV_32F, weights[None], anchor=(middle, 0), borderType=border)
    lower = cv2.filter2D(levels, cv2.CV_32F, weights[:, None], anchor=(0, middle), borderType=border)
    return np.asarray(right)[:, :-1], np.asarray(lower)[:-1]


def along(lines: Array, *, loosely: bool) -> tuple[Array, Array]:
    """float32: 1 for the cracks beside a pixel of ``lines`` (bool (H, W)), or ``loosely`` one pixel further."""
    import cv2

    wide = lines.astype(np.float32)
    if loosely:
        wide = np.asarray(cv2.dilate(wide, np.ones((3, 3), np.uint8)))
    return np.maximum(wide[:, :-1], wide[:, 1:]), np.maximum(wide[:-1], wide[1:])
