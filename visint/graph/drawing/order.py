"""The order of the cells in each row, so that few edges cross: sweeps of the barycentre heuristic (Sugiyama,
Tagawa and Toda 1981, DOI 10.1109/TSMC.1981.4308636), the best of them kept.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from visint.graph.drawing.lattice import Cell, Lattice, Link

__all__ = ["crossings", "reorder"]

SWEEPS = 12

Rows = list[list[Cell]]
Spot = Callable[[Link], float]


def reorder(found: Lattice) -> None:
    """Orders every row of ``found``, in place."""
    between = found.between()
    best, least = [list(row) for row in found.rows], crossings(found.rows, between)
    for turn in range(SWEEPS):
        _sweep(found.rows, between, down=turn % 2 == 0)
        now = crossings(found.rows, between)
        if now < least:
            best, least = [list(row) for row in found.rows], now
    found.rows[:] = best


def _sweep(rows: Rows, between: Sequence[Sequence[Link]], down: bool) -> None:
    depth = len(rows)
    for row in range(1, depth) if down else range(depth - 2, -1, -1):
        links = between[row - 1] if down else between[row]
        near = _spots(rows[row - 1 if down else row + 1])
        pulls: dict[Cell, list[float]] = {}
        for link in links:
            cell = link.lower if down else link.upper
            pulls.setdefault(cell, []).append(_upper(near)(link) if down else _lower(near)(link))
        _sort(rows[row], pulls)


def _sort(row: list[Cell], pulls: dict[Cell, list[float]]) -> None:
    """Cells with neighbours are sorted among themselves; the others keep their places."""
    drawn = [cell for cell in row if cell in pulls]
    drawn.sort(key=lambda cell: sum(pulls[cell]) / len(pulls[cell]))
    ordered = iter(drawn)
    row[:] = [next(ordered) if cell in pulls else cell for cell in row]


def _spots(row: Sequence[Cell]) -> dict[Cell, float]:
    return {cell: float(index) for index, cell in enumerate(row)}


def _upper(spots: dict[Cell, float]) -> Spot:
    return lambda link: spots[link.upper] + (link.start / link.upper.w - 0.5 if link.upper.w else 0.0)


def _lower(spots: dict[Cell, float]) -> Spot:
    return lambda link: spots[link.lower] + (link.end / link.lower.w - 0.5 if link.lower.w else 0.0)


def crossings(rows: Rows, between: Sequence[Sequence[Link]]) -> int:
    """How many pairs of links cross."""
    total = 0
    for row, links in enumerate(between[:-1]):
        start, end = _upper(_spots(rows[row])), _lower(_spots(rows[row + 1]))
        ends = [e for _, e in sorted((start(link), end(link)) for link in links)]
        total += sum(one > other for i, one in enumerate(ends) for other in ends[i + 1 :])
    return total
