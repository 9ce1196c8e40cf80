"""A reproduced table as columns of text."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from visint_lab.trials.grid import number
from visint_lab.trials.improvement import RowResult
from visint_lab.trials.published import ImprovementTable

__all__ = ["columns", "remarks", "rows_of"]


def columns(results: Sequence[RowResult]) -> list[str]:
    """The systems that ran, the baseline first."""
    names: list[str] = []
    for result in results:
        for outcome in result.outcomes:
            names += [name for name in outcome.maps if name not in names]
    return names


def rows_of(results: Sequence[RowResult]) -> tuple[list[str], list[list[str]]]:
    """(head, rows): published shape and depth reductions, ours of every system, then errors of the baseline
    and of a constant plane. A spread over seeds stands behind as lowest…highest.
    """
    systems = columns(results)
    head = ["", "published S/D", *(f"{name} S/D" for name in systems[1:])]
    head += [f"{name} rmse/S" for name in (*systems[:1], "constant plane")]
    return head, [_row(result, systems) for result in results]


def _row(result: RowResult, systems: Sequence[str]) -> list[str]:
    published = f"{number(result.row.shape)}/{number(result.row.depth)}"
    ours = [_reduced(result, name) for name in systems[1:]]
    return [result.row.label, published, *ours, *(_errors(result, n) for n in (systems[0], "constant plane"))]


def _reduced(result: RowResult, system: str) -> str:
    middle = result.middle(system)
    if middle is None:
        return "–"
    text = f"{number(middle.shape)}/{number(middle.depth)}"
    found = result.reductions(system)
    if len(found) == 1:
        return text
    spreads = [sorted(getattr(one, part) for one in found) for part in ("shape", "depth")]
    return text + " (" + ", ".join(f"{number(s[0], 0)}…{number(s[-1], 0)}" for s in spreads) + ")"


def _errors(result: RowResult, system: str) -> str:
    found = [one.scores[system] for one in result.outcomes]
    return "/".join(number(median(one[key] for one in found), 2) for key in ("rmse", "s"))


def remarks(table: ImprovementTable, results: Sequence[RowResult], missing: Sequence[str]) -> list[str]:
    """What to mind: systems that are not there, rows made worse, errata, choices."""
    told = [f"{name} is not there yet: its columns are missing." for name in missing]
    told += [_worse(results, system) for system in columns(results)[1:]]
    told.append(
        "S/D: reduction, %, of the mean squared normal / depth error over all foreground, against "
        f"{columns(results)[0]} alone on the same images with the same filling; negative is worse."
    )
    return [*told, *table.notes]


def _worse(results: Sequence[RowResult], system: str) -> str:
    found = [one for result in results for one in result.reductions(system)]
    worse = sum(one.depth < 0 for one in found), sum(one.shape < 0 for one in found)
    return f"{system}: depth made worse in {worse[0]}, shape in {worse[1]} of {len(found)} scenes."
