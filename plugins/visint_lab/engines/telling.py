"""The contest as a table, and what its notes say."""

from __future__ import annotations

from collections.abc import Sequence

from visint_lab.engines.contest import OURS, Heat, Spread
from visint_lab.trials.grid import number

__all__ = ["head", "notes", "rows"]


def head(chains: Sequence[int]) -> list[str]:
    """The columns: µs a node by length (median and least), µs a turn, milliseconds of imports, ratios."""
    lengths = [f"µs a node, {nodes}" for nodes in chains]
    return ["", *lengths, "µs a turn", "× node", "× turn", f"{chains[0]} to {chains[-1]}", "import ms"]


def rows(heats: Sequence[Heat], chains: Sequence[int]) -> list[list[str]]:
    """One engine a row: median (least). Ratios are of the least ones, to ours."""
    ours = next(heat for heat in heats if heat.engine == OURS)
    return [_row(heat, ours, chains) for heat in heats]


def _row(heat: Heat, ours: Heat, chains: Sequence[int]) -> list[str]:
    if heat.turn is None or ours.turn is None:
        return [heat.engine, *["–"] * (len(chains) + 5)]
    middle = chains[len(chains) // 2]
    return [
        f"{heat.engine} {heat.version}",
        *(_spread(heat.node[nodes]) for nodes in chains),
        _spread(heat.turn),
        number(heat.node[middle].least / ours.node[middle].least, 2),
        number(heat.turn.least / ours.turn.least, 2),
        number(heat.node[chains[-1]].least / heat.node[chains[0]].least, 2),
        number(heat.imported, 0),
    ]


def _spread(spread: Spread) -> str:
    digits = 2 if spread.least < 1 else 1 if spread.least < 100 else 0
    return f"{number(spread.median, digits)} ({number(spread.least, digits)})"


def notes(heats: Sequence[Heat], chains: Sequence[int], size: int) -> list[str]:
    """What was timed, what only this engine tells, and which peers are missing."""
    ours = next(heat for heat in heats if heat.engine == OURS)
    middle, ends = chains[len(chains) // 2], f"{chains[0]} to {chains[-1]}"
    told = [
        f"Whole runs of chains whose nodes pass on a {size}×{size} float32 image, and of a loop of four nodes.",
        "Median (least) over runs of a graph that is built and warm.",
        "visint: every port checked, every call timed, two events a node to an observer.",
        f"×: the least time of the row over visint's, at {middle} nodes. {ends}: how a node's time grows.",
    ]
    if ours.preparation:
        spent = ", ".join(f"{name} {value:.1f}" for name, value in ours.preparation.items())
        told.append(f"visint, milliseconds for 100 nodes: {spent} (of them 'bind' checks every rule).")
    return [*told, *(f"{heat.engine}: {heat.failure}" for heat in heats if heat.failure)]
