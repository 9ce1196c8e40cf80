"""Exact inference on a line diagram: arcs are eliminated one by one, each with all that mentions it.

Bucket elimination (Dechter 1999, DOI 10.1016/S0004-3702(99)00059-4). Line diagrams are planar and nearly trees:
the tables stay small. Where one would not, its arc with most neighbours is fixed to its likeliest label.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_lines.factors import Factor

__all__ = ["Answer", "count", "solve"]

WIDEST = 6
"""Arcs in one table at most: 7⁶ entries."""


class Answer(NamedTuple):
    """``best``: int (A,), the likeliest labelling; ``marginals``: float (A, K); ``exact``: no arc was fixed."""

    best: Array
    marginals: Array
    exact: bool


class _Bucket(NamedTuple):
    """An eliminated arc: its table over itself and ``rest``, and the message left over ``rest``."""

    arc: int
    rest: tuple[int, ...]
    table: Array
    message: Array


def solve(unary: Array, factors: Sequence[Factor]) -> Answer:
    """The likeliest labelling and the probability of each label of each arc.

    Parameters
    ----------
    unary
        float (A, K): log probabilities of each arc alone.
    factors
        Log weights over the labels of arcs that meet.
    """
    unary, fixed = _narrowed(unary, factors)
    best = _backwards(_eliminated(unary, factors, _best), len(unary))
    marginals = _marginals(_eliminated(unary, factors, _sum), unary.shape)
    return Answer(best, marginals, not fixed)


def count(unary: Array, factors: Sequence[Factor]) -> float:
    """The sum of the weights of all labellings: their number where every weight is 0 or 1."""
    buckets = _eliminated(unary, factors, _sum)
    return float(np.exp(sum(float(bucket.message) for bucket in buckets if not bucket.rest)))


def _narrowed(unary: Array, factors: Sequence[Factor]) -> tuple[Array, list[int]]:
    """``unary`` with arcs fixed, those with most neighbours first, until no table is too wide."""
    unary = unary.copy()
    fixed: list[int] = []
    while True:
        free = [_without(f.arcs, fixed) for f in factors]
        order = _order(len(unary), free)
        wide = max(order, key=lambda step: len(step[1]), default=(0, ()))
        if len(wide[1]) + 1 <= WIDEST:
            return unary, fixed
        degree = {arc: sum(arc in arcs for arcs in free) for arc in (wide[0], *wide[1])}
        arc = max(degree, key=lambda one: degree[one])
        fixed.append(arc)
        others = np.arange(unary.shape[1]) != unary[arc].argmax()
        unary[arc, others] = -np.inf


def _without(arcs: tuple[int, ...], fixed: list[int]) -> tuple[int, ...]:
    return tuple(arc for arc in arcs if arc not in fixed)


def _order(size: int, scopes: Sequence[tuple[int, ...]]) -> list[tuple[int, tuple[int, ...]]]:
    """(arc, neighbours left) in an order that keeps tables small: fewest neighbours first."""
    near: list[set[int]] = [set() for _ in range(size)]
    for scope in scopes:
        for arc in scope:
            near[arc] |= set(scope) - {arc}
    left, order = set(range(size)), []
    while left:
        arc = min(left, key=lambda one: (len(near[one]), one))
        rest = tuple(sorted(near[arc]))
        for one in rest:
            near[one] |= set(rest) - {one}
            near[one].discard(arc)
        left.discard(arc)
        order.append((arc, rest))
    return order


def _eliminated(unary: Array, factors: Sequence[Factor], fold: object) -> list[_Bucket]:
    certain = np.isinf(unary).sum(axis=1) == unary.shape[1] - 1
    pending = [_given(f, unary, certain) for f in factors]
    buckets = []
    for arc, _ in _order(len(unary), [f.arcs for f in pending]):
        mine = [f for f in pending if arc in f.arcs]
        pending = [f for f in pending if arc not in f.arcs]
        rest = tuple(sorted({one for f in mine for one in f.arcs} - {arc}))
        table = _spread(Factor((arc,), unary[arc]), (arc, *rest))
        for factor in mine:
            table = table + _spread(factor, (arc, *rest))
        table = np.broadcast_to(table, (unary.shape[1],) * (1 + len(rest)))
        message = fold(table)  # type: ignore[operator]
        buckets.append(_Bucket(arc, rest, table, message))
        if rest:
            pending.append(Factor(rest, message))
    return buckets


def _given(factor: Factor, unary: Array, certain: Array) -> Factor:
    """The factor with the labels of fixed arcs put in."""
    index = tuple(int(unary[a].argmax()) if certain[a] else slice(None) for a in factor.arcs)
    return Factor(tuple(a for a in factor.arcs if not certain[a]), factor.table[index])


def _spread(factor: Factor, arcs: tuple[int, ...]) -> Array:
    """The factor's table with axes in the order of ``arcs``, 1 long where it does not mention one."""
    order = sorted(range(len(factor.arcs)), key=lambda i: arcs.index(factor.arcs[i]))
    shape = tuple(factor.table.shape[factor.arcs.index(a)] if a in factor.arcs else 1 for a in arcs)
    return factor.table.transpose(order).reshape(shape)


def _best(table: Array) -> Array:
    return np.asarray(table.max(axis=0))


def _sum(table: Array) -> Array:
    top = table.max(axis=0)
    safe = np.where(np.isfinite(top), top, 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(safe + np.log(np.exp(table - safe).sum(axis=0)))


def _backwards(buckets: list[_Bucket], size: int) -> Array:
    best = np.zeros(size, dtype=np.int64)
    for bucket in reversed(buckets):
        best[bucket.arc] = bucket.table[(slice(None), *(best[one] for one in bucket.rest))].argmax()
    return best


def _marginals(buckets: list[_Bucket], shape: tuple[int, ...]) -> Array:
    """Beliefs from the last bucket back to the first: each gets from its parent what it did not tell it."""
    position = {bucket.arc: i for i, bucket in enumerate(buckets)}
    beliefs: dict[int, tuple[tuple[int, ...], Array]] = {}
    told = np.zeros(shape)
    for bucket in reversed(buckets):
        belief = bucket.table
        if bucket.rest:
            parent = min(bucket.rest, key=lambda one: position[one])
            arcs, above = beliefs[parent]
            kept = _folded(above, arcs, bucket.rest)
            with np.errstate(invalid="ignore"):
                news = np.nan_to_num(kept - bucket.message, nan=-np.inf, neginf=-np.inf, posinf=0.0)
            belief = belief + news[None]
        beliefs[bucket.arc] = ((bucket.arc, *bucket.rest), belief)
        own = _folded(belief, (bucket.arc, *bucket.rest), (bucket.arc,))
        share = np.exp(own - own.max())
        told[bucket.arc] = share / share.sum()
    return told


def _folded(table: Array, arcs: tuple[int, ...], keep: tuple[int, ...]) -> Array:
    """Summed over all arcs but ``keep``, with axes in their order."""
    moved = table.transpose([arcs.index(a) for a in keep] + [i for i, a in enumerate(arcs) if a not in keep])
    flat = moved.reshape(*moved.shape[: len(keep)], -1)
    return _sum(np.moveaxis(flat, -1, 0))
