"""Regions that hold more than one albedo."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["several_albedos"]

STEPS = 64
SPAN = 2.5
"""Of ln(brightness/cosine) around a region's mean, either way."""


def several_albedos(even: Array, shade: Array, labels: Array) -> Array:
    """Bool (N + 1,) by label: ln(brightness / cosine) falls into two groups.

    Two groups as Otsu (1979) parts them: together they must explain 85 % of the variance (one bell leaves 36 %,
    one box 25 %), the smaller must hold a twentieth of the pixels, and their means must lie 15 % apart.
    """
    count = int(labels.max(initial=0)) + 1
    usable = (labels > 0) & (shade > 0.4) & (even > 0)
    label = labels[usable]
    value = np.log(even[usable] / shade[usable]).astype(np.float64)
    members = np.bincount(label, minlength=count)
    centre = np.bincount(label, value, minlength=count) / np.maximum(members, 1)
    step = np.clip((value - centre[label] + SPAN) * (STEPS / (2 * SPAN)), 0, STEPS - 1).astype(np.int64)
    table = np.bincount(label * np.int64(STEPS) + step, minlength=count * STEPS).reshape(count, STEPS)
    return _in_two(table / np.maximum(members, 1)[:, None]) & (members > 30)


def _in_two(share: Array) -> Array:
    """Bool by row of histograms (N, STEPS) that sum to 1."""
    place = (np.arange(STEPS) + 0.5) * (2 * SPAN / STEPS) - SPAN
    below = np.cumsum(share, axis=1)
    moment = np.cumsum(share * place, axis=1)
    mean = moment[:, -1:]
    variance = (share * place**2).sum(axis=1) - mean[:, 0] ** 2
    apart = below * (1 - below)
    with np.errstate(divide="ignore", invalid="ignore"):
        between = np.where(apart > 1e-9, (mean * below - moment) ** 2 / apart, 0)
        gap = np.where(apart > 1e-9, np.abs(mean * below - moment) / apart, 0)
    best = between.argmax(axis=1)
    row = np.arange(len(share))
    smaller = np.minimum(below[row, best], 1 - below[row, best])
    explained = between[row, best] / np.maximum(variance, 1e-12)
    return np.asarray((explained > 0.85) & (smaller > 0.05) & (gap[row, best] > 0.15))
