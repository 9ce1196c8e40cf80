"""Where the cells of each row stand: as near to their neighbours as their order and sizes allow.

Row after row, the sum of the edges' sideways steps is made small: at first of their squares, then, by weights
made anew from the steps themselves, of their lengths, which leaves many edges upright and a few aslant.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from visint.graph.drawing.lattice import Cell, Lattice, Link

__all__ = ["place", "settle"]

ROUGH, FINE = 8, 60
"""Sweeps of either sort."""
APART, PASSING = 26.0, 16.0
"""The least room between two blocks, and beside a way."""
NEARLY, COOLING = 8.0, 0.94
"""Sideways steps below this many pixels still weigh by their square; a fine sweep lowers the bound so much."""

Between = Sequence[Sequence[Link]]


def place(found: Lattice) -> None:
    """Sets ``x`` of every cell, in place; the leftmost stands at 0."""
    for cells in found.rows:
        _spread(cells)
    between = found.between()
    for turn in range(ROUGH + FINE):
        order = range(len(found.rows))
        nearly = NEARLY * COOLING ** (turn - ROUGH) if turn >= ROUGH else math.inf
        for row in order if turn % 2 == 0 else reversed(order):
            _pull(found.rows[row], _links(between, row, turn), nearly)
    left = min((cell.x for row in found.rows for cell in row), default=0.0)
    for cell in (cell for row in found.rows for cell in row):
        cell.x -= left


def _links(between: Between, row: int, turn: int) -> Sequence[Link]:
    """What pulls at a row: the row before it in a rough sweep, both its neighbours in a fine one."""
    above = between[row - 1] if row else []
    if turn < ROUGH:
        return above if turn % 2 == 0 else between[row]
    return [*above, *between[row]]


def _spread(row: Sequence[Cell]) -> None:
    for cell, start in zip(row, [*_starts(row)], strict=True):
        cell.x = start
    middle = (row[-1].x + row[-1].w) / 2 if row else 0.0
    for cell in row:
        cell.x -= middle


def _starts(row: Sequence[Cell]) -> Iterator[float]:
    """The left sides of the cells of ``row`` if they stand as close as they may."""
    at = 0.0
    for index, cell in enumerate(row):
        if index:
            at += APART if cell.block and row[index - 1].block else PASSING
        yield at
        at += cell.w


def _pull(row: Sequence[Cell], links: Sequence[Link], nearly: float) -> None:
    """Moves the cells of ``row`` towards where ``links`` would be upright."""
    pulls: dict[Cell, list[tuple[float, float]]] = {cell: [] for cell in row}
    for link in links:
        weight = _weight(link, nearly)
        if link.lower in pulls:
            pulls[link.lower].append((link.upper.x + link.start - link.end, weight))
        if link.upper in pulls:
            pulls[link.upper].append((link.lower.x + link.end - link.start, weight))
    wanted = [_mean(pulls[cell]) if pulls[cell] else (cell.x, 0.05) for cell in row]
    starts = [*_starts(row)]
    free = settle([x - start for (x, _), start in zip(wanted, starts, strict=True)], [w for _, w in wanted])
    for cell, x, start in zip(row, free, starts, strict=True):
        cell.x = x + start


def _weight(link: Link, nearly: float) -> float:
    """Long edges, which pass rows by ways, are to be straight first of all."""
    weight = 8.0 if not link.upper.block and not link.lower.block else 1.0
    step = abs(link.upper.x + link.start - link.lower.x - link.end)
    return weight if step <= nearly else weight * nearly / step


def _mean(pulls: Sequence[tuple[float, float]]) -> tuple[float, float]:
    total = sum(weight for _, weight in pulls)
    return sum(x * weight for x, weight in pulls) / total, total


def settle(wanted: Sequence[float], weights: Sequence[float]) -> list[float]:
    """The rising numbers nearest to ``wanted`` in weighted least squares, by pooling those that do not rise."""
    pools: list[tuple[float, float, int]] = []
    for x, weight in zip(wanted, weights, strict=True):
        pools.append((x, weight, 1))
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (right, heavy, many), (left, light, few) = pools.pop(), pools.pop()
            total = heavy + light
            pools.append(((right * heavy + left * light) / total, total, many + few))
    return [x for x, _, many in pools for _ in range(many)]
