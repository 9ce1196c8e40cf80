"""Which row of a layout each block stands in: the longest path that leads to it, in rows not too wide."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

__all__ = ["forward", "ranks"]

WIDEST = 7
"""Blocks in a row; more are set in further rows."""

Pair = tuple[int, int]


def forward(pairs: Iterable[Pair]) -> list[Pair]:
    """``pairs`` without those that close a circle: a graph may be drawn before it is right."""
    after: dict[int, list[int]] = {}
    kept: list[Pair] = []
    for source, target in pairs:
        if source != target and not _leads(after, target, source):
            after.setdefault(source, []).append(target)
            kept.append((source, target))
    return kept


def _leads(after: Mapping[int, Sequence[int]], start: int, goal: int) -> bool:
    seen, waiting = {start}, [start]
    while waiting:
        here = waiting.pop()
        if here == goal:
            return True
        fresh = [one for one in after.get(here, ()) if one not in seen]
        seen.update(fresh)
        waiting += fresh
    return False


def ranks(count: int, pairs: Sequence[Pair], first: Sequence[int], last: Sequence[int]) -> list[int]:
    """The row of each of ``count`` blocks; ``first`` stand above, ``last`` below all others."""
    rank = [0 if index in first or not first else 1 for index in range(count)]
    _lengthen(rank, pairs)
    deepest = max((rank[i] for i in range(count) if i not in last), default=-1)
    for index in last:
        rank[index] = deepest + 1
    return _split(rank)


def _lengthen(rank: list[int], pairs: Sequence[Pair]) -> None:
    """Moves each block below all that lead to it; ``pairs`` close no circle, so this ends."""
    changed = True
    while changed:
        changed = False
        for source, target in pairs:
            if rank[target] <= rank[source]:
                rank[target], changed = rank[source] + 1, True


def _split(rank: Sequence[int]) -> list[int]:
    """Full rows broken into several, as even as may be; empty ones closed up."""
    found, row = [0] * len(rank), 0
    for old in sorted(set(rank)):
        members = [index for index, one in enumerate(rank) if one == old]
        parts = -(-len(members) // WIDEST)
        size = -(-len(members) // parts)
        for place, index in enumerate(members):
            found[index] = row + place // size
        row += parts
    return found
