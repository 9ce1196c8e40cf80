"""The reference: the site whose orientation the map knows best."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_texture.geometry.tangent import Positions, slopes_of_normal, surface_log_moments
from visint_texture.surface.relief import Anchor
from visint_texture.surface.sites import Sites

__all__ = ["anchor_at", "best_known"]


def best_known(sites: Sites, normals: Array, confidence: Array) -> tuple[int, int] | None:
    """The place (row, column) where texture and the map are best known; None where neither is anywhere.

    The middle of equally good ones: far from the rim, where windows reach across.
    """
    score = np.where(np.isfinite(normals).all(axis=-1), confidence, 0) * np.minimum(sites.weight, 1)
    if not score.max() > 0:
        return None
    rows, columns = np.nonzero(score >= 0.98 * score.max())
    middle = (rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2
    nearest = int(middle.argmin())
    return int(rows[nearest]), int(columns[nearest])


def anchor_at(sites: Sites, place: tuple[int, int], normal: Array) -> Anchor:
    """The reference at ``place`` with its known ``normal`` (3,): what the texture's log moments are there.

    The mean over the site and its neighbours, as if they had the same orientation.
    """
    around = tuple(slice(max(0, i - 1), i + 2) for i in place)
    here = Positions(sites.at.across[place], sites.at.down[place])
    a, b = slopes_of_normal(here, normal)
    near = Positions(sites.at.across[around], sites.at.down[around])
    w = np.maximum(1 + a * (near.across - here.across) + b * (near.down - here.down), 0.05)
    logs = surface_log_moments(sites.moments[around], near, w, a / w, b / w)
    weight = sites.weight[around][..., None] + 1e-9
    return Anchor(place, (float(a), float(b)), (logs * weight).sum(axis=(0, 1)) / weight.sum())
