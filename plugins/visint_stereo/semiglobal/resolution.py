"""Large pairs: matched small first, then in a band around what that gave, strip by strip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np

from visint.arrays import Array
from visint.fields.resampling import block_mean, nearest_up
from visint_stereo.semiglobal.match import Match, Settings, matched
from visint_stereo.semiglobal.volume import Check, Levels, Prior

__all__ = ["CELLS", "matched_within"]

CELLS = 40_000_000
"""Pixels times levels matched at once; three bytes each."""
BAND = 16
"""Levels searched around what half the resolution found: the finest detail may lie 8 px off it."""
STRIP = 1 << 20
"""Pixels of a strip, beyond which rows are matched apart."""
OVERLAP = 24
"""Rows that strips share; paths have forgotten most of what lies further."""


def matched_within(  # noqa: PLR0913 - a match, and how much of it at once
    left: Array,
    right: Array,
    levels: Levels,
    settings: Settings,
    check: Check,
    cells: int = CELLS,
    *,
    prior: Prior | None = None,
) -> Match:
    """The match of two linear views (H, W), in one piece if it takes at most ``cells``, else coarse to fine.

    Memory then grows with the pixels alone, and so does time.
    """
    if left.size * levels.count <= cells or min(left.shape) < 4 * BAND:
        return matched(left, right, levels, settings, check, prior)
    half = Levels(levels.first // 2, -(-levels.count // 2) + 1)
    small = replace(settings, speckle=settings.speckle // 4)
    smaller = prior and prior.halved()
    coarse = matched_within(block_mean(left), block_mean(right), half, small, check, cells, prior=smaller)
    band = _band(nearest_up(2 * coarse.disparity, left.shape), levels)
    strips = [_strip((left, right), band, rows, settings, check, prior) for rows in _strips(left.shape)]
    joined = {f.name: np.concatenate([getattr(strip, f.name) for strip in strips]) for f in fields(Match)}
    return Match(**joined)


def _band(expected: Array, levels: Levels) -> Levels:
    """Levels around an expected disparity (H, W); NaN expects the middle of the range."""
    middle = levels.first + levels.count / 2
    centre = np.rint(np.nan_to_num(expected, nan=middle)).astype(np.int32)
    room = max(levels.count - BAND, 0)
    return Levels(levels.first, BAND, np.clip(centre - BAND // 2 - levels.first, 0, room).astype(np.int32))


def _strips(shape: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """(first row, row after the last) of each strip, without overlap."""
    rows = max(4 * OVERLAP, STRIP // shape[1])
    count = -(-shape[0] // rows)
    edges = np.linspace(0, shape[0], count + 1).astype(int)
    return zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)


def _strip(
    views: tuple[Array, Array],
    band: Levels,
    rows: tuple[int, int],
    settings: Settings,
    check: Check,
    prior: Prior | None,
) -> Match:
    left, right = views
    above, below = min(OVERLAP, rows[0]), min(OVERLAP, left.shape[0] - rows[1])
    part = slice(rows[0] - above, rows[1] + below)
    levels = replace(band, base=np.ascontiguousarray(band.lowest(left.shape)[part]))
    match = matched(left[part], right[part], levels, settings, check, prior and prior.rows(part))
    inner = slice(above, above + rows[1] - rows[0])
    return Match(**{f.name: getattr(match, f.name)[inner] for f in fields(Match)})
