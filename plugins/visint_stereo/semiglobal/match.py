"""One pair, matched from costs to reliability, at one resolution."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from visint.arrays import Array
from visint_stereo.semiglobal.brightness import graded
from visint_stereo.semiglobal.consistency import agreed, backed, occluded, without_speckles
from visint_stereo.semiglobal.fill import evened, filled
from visint_stereo.semiglobal.refine import refined
from visint_stereo.semiglobal.reliability import TrainedOn, contrast, reliability, signs
from visint_stereo.semiglobal.volume import (
    Check,
    Levels,
    Penalties,
    Prior,
    Volume,
    census,
    lean_on,
    matching_costs,
    path_costs,
)
from visint_stereo.semiglobal.winner import Winners, winners

__all__ = ["Match", "Settings", "matched"]

FILLED = 4.0
"""Sigma of a disparity filled from its neighbours, px."""
FLAT = 0.1
"""The most that a pixel without any texture around is trusted: all it has comes from afar."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What a match depends on beside the images: penalties, px that views may differ, px² of a speckle."""

    penalties: Penalties = field(default_factory=Penalties)
    tolerance: float = 1.0
    speckle: int = 100
    trained_on: TrainedOn = "all"


@dataclass(frozen=True, slots=True)
class Match:
    """Of the left view, (H, W) each: ``disparity`` and ``sigma`` in px and ``trust`` in [0, 1], float32;
    ``consistent`` (both views agree) and ``hidden`` (from the right view), bool. Of the right view: ``right``,
    float32, px, its disparity where the left pixel that it matches is consistent, else NaN.
    """

    disparity: Array
    sigma: Array
    trust: Array
    consistent: Array
    hidden: Array
    right: Array


def matched(
    left: Array, right: Array, levels: Levels, settings: Settings, check: Check, prior: Prior | None = None
) -> Match:
    """The match of two linear float32 views (H, W) among ``levels``, along ``prior`` if there is one."""
    here, there = graded(left), graded(right)
    won = _won((here, there), levels, settings.penalties, check, prior)
    check()
    seen = np.isfinite(left) & (contrast(here) > 0)
    trusted = seen & agreed(won.disparity, won.right, settings.tolerance)
    trusted = without_speckles(won.disparity, trusted, settings.speckle)
    views = (here.astype(np.float32) / 16, there.astype(np.float32) / 16)
    fine, sigma = refined(won.disparity, trusted, views, levels)
    disparity = evened(filled(fine, trusted, won.right, levels, here, check))
    trust = reliability(signs(here, won, trusted, np.nan_to_num(disparity)), settings.trained_on)
    return Match(
        disparity,
        np.where(trusted, sigma, np.float32(FILLED)),
        np.where(seen, trust, np.minimum(trust, np.float32(FLAT))),
        trusted,
        occluded(won.disparity, won.right, trusted),
        np.where(backed(won.right, trusted), won.right, np.float32(np.nan)).astype(np.float32),
    )


def _won(
    grades: tuple[Array, Array], levels: Levels, penalties: Penalties, check: Check, prior: Prior | None
) -> Winners:
    """The winners; the volumes they come from are gone when this returns."""
    here, there = grades
    cost = matching_costs(census(here), census(there), levels, penalties.outside)
    if prior is not None:
        lean_on(cost, prior, levels)
    check()
    return winners(Volume(levels, path_costs(cost, levels, here, penalties, check, prior)))
