"""Means inside regions: no value crosses into another region, none comes from where nothing is known."""

from __future__ import annotations

import math

import numpy as np

from visint.arrays import Array

__all__ = ["evened", "evened_inside", "gain"]

ROUNDS = 2


def evened(values: Array, weight: Array, labels: Array, length: float) -> tuple[Array, Array]:
    """Weighted local means of ``values`` and how much weight stood behind them.

    Parameters
    ----------
    values
        float32 (C, H, W), already multiplied by ``weight`` float32 (H, W).
    labels
        int32 (H, W): means stop where the label changes.
    length
        Standard deviation of the mean's window, pixels; below 0.3 values are returned as they are.

    Returns
    -------
    float32 (C, H, W), NaN where no weight is near; float32 (H, W).
    """
    both = _spread(np.concatenate([values, weight[None]]).astype(np.float32, copy=False), labels, length)
    sure = both[-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(sure > 1e-4, both[:-1] / sure, np.float32(np.nan)), sure


def evened_inside(values: Array, labels: Array, length: float) -> Array:
    """The same of ``values`` float32 (H, W) that are known at every label but 0; NaN at label 0."""
    inside = labels > 0
    mean: Array = _spread(np.where(inside, values, np.float32(0))[None], labels, length)[0]
    mean[~inside] = np.nan
    return mean


def _spread(both: Array, labels: Array, length: float) -> Array:
    """``both`` float32 (C, H, W) or what is made of it in place: every plane's means inside regions."""
    from visint_shading import _kernels

    if length >= 0.3 and min(labels.shape) > 0:
        down, across = _joined(labels), _joined(_turned(labels[None])[0])
        for decay in _decays(length):  # along rows as along columns of the transposed: there pixels go abreast
            _kernels.evened(down, decay, both)
            both = _turned(both)
            _kernels.evened(across, decay, both)
            both = _turned(both)
    return both


def _turned(planes: Array) -> Array:
    """(C, W, H) of (C, H, W), of 4 bytes each."""
    import cv2

    found = np.empty((planes.shape[0], planes.shape[2], planes.shape[1]), planes.dtype)
    for plane, into in zip(planes, found, strict=True):
        cv2.transpose(plane, dst=into)
    return found


def _joined(labels: Array) -> Array:
    """float32 (H, W): 1 where a pixel has the label of the one above it."""
    same = np.zeros(labels.shape, np.float32)
    same[1:] = labels[1:] == labels[:-1]
    return same


def _decays(length: float) -> Array:
    """What a neighbour keeps in each round, so that all together have the variance of ``length``²."""
    shares = [math.sqrt(3) * 2 ** (ROUNDS - i - 1) / math.sqrt(4**ROUNDS - 1) for i in range(ROUNDS)]
    return np.array([math.exp(-math.sqrt(2) / (length * share)) for share in shares], np.float32)


def gain(length: float) -> float:
    """What is left of white noise's standard deviation after :func:`evened` by ``length``."""
    return 1.0 if length < 0.3 else min(1.0, 1 / (2 * math.sqrt(math.pi) * length))
