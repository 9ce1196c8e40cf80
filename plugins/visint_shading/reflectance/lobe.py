"""Highlights by their shape: what a lobe around the mirrored light explains and the cosine does not."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["lobe_of"]

SHARPNESS = (6.0, 12.0, 24.0, 48.0, 96.0)
FAINTEST = 0.06
"""A lobe whose top is darker than so much of the albedo is none."""


def lobe_of(even: Array, cosine: Array, mirror: Array, labels: Array) -> Array:
    """Brightness of the lobe, float32 (H, W), 0 where a region has none.

    E = ρ c + g m^k by region, with c = n·l, m the cosine between line of sight and mirrored light (Phong's
    lobe, which section 3.2 writes down) and five sharpnesses k, by least squares. A region has a lobe if ρ and
    g are positive and it leaves at most 0.6 of what the cosine alone leaves.
    """
    count = int(labels.max(initial=0)) + 1
    usable = (labels > 0) & (cosine > 0.2) & np.isfinite(mirror)
    label = labels[usable]
    e, c = even[usable].astype(np.float64), cosine[usable].astype(np.float64)
    m = np.clip(mirror[usable], 0, 1).astype(np.float64)
    alone = _left_alone(e, c, label, count)
    best, gloss, sharpness = 0.6 * alone, np.zeros(count), np.ones(count)
    for k in SHARPNESS:
        rho, g, left = _with_lobe(e, c, m**k, label, count)
        better = (left < best) & (rho > 0) & (g > FAINTEST * rho)
        best = np.where(better, left, best)
        gloss, sharpness = np.where(better, g, gloss), np.where(better, k, sharpness)
    bright = gloss[labels] * np.clip(np.nan_to_num(mirror), 0, 1) ** sharpness[labels]
    return np.where(usable, bright, 0).astype(np.float32)


def _left_alone(e: Array, c: Array, label: Array, count: int) -> Array:
    ee, cc, ec = (np.bincount(label, v, minlength=count) for v in (e * e, c * c, e * c))
    return np.maximum(ee - ec**2 / np.maximum(cc, 1e-12), 0)


def _with_lobe(e: Array, c: Array, lobe: Array, label: Array, count: int) -> tuple[Array, Array, Array]:
    """ρ, g and the squares left, by region."""
    cc, cs, ss, ce, se, ee = (
        np.bincount(label, v, minlength=count) for v in (c * c, c * lobe, lobe * lobe, c * e, lobe * e, e * e)
    )
    det = cc * ss - cs * cs
    sound = det > 1e-6 * np.maximum(cc * ss, 1e-12)
    det = np.where(sound, det, 1)
    rho, g = (ce * ss - se * cs) / det, (se * cc - ce * cs) / det
    return rho, np.where(sound, g, 0), np.maximum(ee - rho * ce - g * se, 0)
