"""Which plane each region takes: its own or one from around, by energy with visibility."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_grouping.planes.listing import Listing, Neighbours, listing_of, neighbours_of
from visint_grouping.planes.votes import Ballot

__all__ = ["Chosen", "Limits", "chosen_planes"]

HYPOTHESES, STEEPEST, REACH, WIDTH, RIDGE, LOOKED_AT = 60, 0.6, 1.0, 1.5, 400.0, 250
"""Fitting: planes tried, the steepest slope (px of disparity a px), px within which a voter is for a plane,
Tukey's width, votes·px² that hold slopes back, voters that a hypothesis is scored on."""
SUPPORT, SHARE = 20.0, 0.5
"""Votes and the share of them within reach that make a fitted plane a candidate."""
FOREIGN, TINT, AGREEMENT = 0.03, 0.1, 0.1
"""Energy: what a plane from elsewhere costs, what another colour adds (all of it from 40 grey levels on), and
what is gained where all neighbours have the same plane."""
UNSEEN = (0.3, 0.3)
"""Energy of a pixel without a vote that the right view cannot see: outside its image, and hidden."""
FEW = 0.02
"""Votes a pixel below which a region's own voters are not asked."""
SWEEPS = 2


class Limits(NamedTuple):
    """What a plane has to meet: most energy, and the least share of the region's own votes within 1 px."""

    energy: float
    share: float


class Chosen(NamedTuple):
    """Of each region: ``planes`` float64 (R, 3), NaN where none is accepted; ``energy``, ``share`` float32."""

    planes: Array
    energy: Array
    share: Array


def chosen_planes(
    labels: Array, levels: Array, ballot: Ballot, words: tuple[Array, Array] | None, limits: Limits
) -> Chosen:
    """The accepted planes of ``labels`` (int32 (H, W) from 0); ``levels`` float32 (H, W, C): colour."""
    from visint_grouping.planes import _kernels

    count = int(labels.max(initial=-1)) + 1
    listing, around = listing_of(labels, count), neighbours_of(labels, count)
    planes, able = _fitted(ballot, listing)
    candidates, offsets = _candidates(around, able, count)
    costs = np.empty(len(candidates), np.float32)
    coverage = np.empty((len(candidates), 2), np.float32)
    views = words if words is not None else (np.zeros(labels.shape, np.uint64),) * 2
    _kernels.energies(*ballot, views, listing, planes, candidates, ballot.span, UNSEEN, costs, coverage)
    costs += _distance(labels, levels, listing, candidates)
    best = np.full(count, -1, np.int64)
    _kernels.settled(costs, offsets, candidates, tuple(around), SWEEPS, AGREEMENT, best)
    return _accepted(best, candidates, planes, (costs, coverage), limits)


def _fitted(ballot: Ballot, listing: Listing) -> tuple[Array, Array]:
    """(planes (R, 3), which of them are candidates)."""
    from visint_grouping.planes import _kernels

    count = len(listing.starts) - 1
    planes, support, share = np.zeros((count, 3)), np.zeros(count, np.float32), np.zeros(count, np.float32)
    settings = (HYPOTHESES, STEEPEST, REACH, WIDTH, RIDGE, LOOKED_AT)
    _kernels.fitted(ballot.disparity, ballot.votes, *listing, settings, planes, support, share)
    return planes, (support >= SUPPORT) & (share >= SHARE)


def _candidates(around: Neighbours, able: Array, count: int) -> tuple[Array, Array]:
    """((M, 2) int32 of (region, plane), region by region; where each region's begin): own and 2-ring planes."""
    from scipy.sparse import csr_array, identity

    ones = np.ones(len(around.neighbour), np.int32)
    beside = csr_array((ones, around.neighbour, around.begins), shape=(count, count)) + identity(
        count, np.int32
    )
    reach = csr_array(beside @ beside)
    regions = np.repeat(np.arange(count), np.diff(reach.indptr))
    keep = able[reach.indices]
    pairs = np.stack([regions[keep], reach.indices[keep]], axis=1).astype(np.int32)
    offsets = np.concatenate([[0], np.cumsum(np.bincount(pairs[:, 0], minlength=count))])
    return pairs, offsets.astype(np.int64)


def _distance(labels: Array, levels: Array, listing: Listing, candidates: Array) -> Array:
    """float32 (M,): what a candidate costs for coming from a region of another place and colour."""
    flat, areas = labels.reshape(-1), np.maximum(listing.areas, 1)
    means = np.stack(
        [np.bincount(flat, levels[..., c].reshape(-1), len(areas)) / areas for c in range(levels.shape[2])],
        axis=1,
    )
    region, source = candidates.T
    apart = np.linalg.norm(means[region] - means[source], axis=1)
    foreign = FOREIGN + TINT * np.minimum(apart / 40, 1)
    return np.where(region == source, 0, foreign).astype(np.float32)


def _accepted(
    best: Array, candidates: Array, planes: Array, judged: tuple[Array, Array], limits: Limits
) -> Chosen:
    costs, coverage = judged
    some = best >= 0
    if not len(costs):
        none = np.full(len(best), np.nan, np.float32)
        return Chosen(np.full((len(best), 3), np.nan), none, none)
    energy = np.where(some, costs[best], np.inf).astype(np.float32)
    share, voted = (np.where(some, part[best], 0).astype(np.float32) for part in coverage.T)
    fine = some & (energy < limits.energy) & ((share >= limits.share) | (voted < FEW))
    taken = np.where(fine[:, None], planes[candidates[best, 1]], np.nan)
    return Chosen(taken, energy, share)
