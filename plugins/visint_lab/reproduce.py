"""Set a published table beside what the systems here give, with their controls."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from visint.arrays import Array
    from visint_lab.trials.improvement import RowResult
    from visint_lab.trials.published import ImprovementTable

EXAMPLES = (
    "Examples: visint reproduce 4.6;  "
    "visint reproduce 5.3 --size 256 --out table;  "
    "visint reproduce 4.5 --seeds 5 --noise 2%"
)


def command(  # noqa: PLR0913, PLR0917 - the options of a command line are many, and typer reads them here
    table: Annotated[str, typer.Argument(help="4.5, 4.6, 4.7, 4.8, 5.2, 5.3 or 5.4.")],
    out: Annotated[Path | None, typer.Option(help="Folder for table.csv and table.html.")] = None,
    size: Annotated[int, typer.Option(min=32, max=2048, help="Rows and columns of the images.")] = 512,
    seeds: Annotated[int, typer.Option(min=0, help="Random poses instead of the chosen one.")] = 0,
    system: Annotated[list[str] | None, typer.Option(help="Graphs beside the table's own.")] = None,
    noise: Annotated[str | None, typer.Option(help="Other noise: none, 2%, 10% or x10%.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
) -> None:
    """Set a published table beside what the systems here give, with their controls."""
    from visint.errors import UsageError
    from visint_lab.trials.published import IMPROVEMENTS, TIMES

    if table in TIMES:
        _times(table, size, out, as_json=as_json)
    elif table in IMPROVEMENTS:
        asked = _with_noise(IMPROVEMENTS[table], noise)
        _improvements(asked, size, _seeds(seeds), system or ["joint"], (out, as_json))
    else:
        known = ", ".join(sorted({**IMPROVEMENTS, **TIMES}))
        raise UsageError.of("VI701", f"no table {table!r} is known here", choices=known)


def _seeds(count: int) -> list[int | None]:
    return list(range(1, count + 1)) or [None]


def _with_noise(table: ImprovementTable, noise: str | None) -> ImprovementTable:
    from dataclasses import replace

    return table if noise is None else replace(table, noise="" if noise == "none" else noise)


def _improvements(
    table: ImprovementTable,
    size: int,
    seeds: list[int | None],
    systems: list[str],
    manner: tuple[Path | None, bool],
) -> None:
    from visint_lab.trials.grid import as_csv
    from visint_lab.trials.improvement import improvements
    from visint_lab.trials.systems import installed
    from visint_lab.trials.telling import remarks, rows_of

    wanted = list(dict.fromkeys([table.system, *systems]))
    results = []
    for result in improvements(table, size, seeds, wanted):
        print(f"{table.number}: {result.row.label}", file=sys.stderr)
        results.append(result)
    head, rows = rows_of(results)
    notes = remarks(table, results, [name for name in wanted if not installed(name)])
    out, as_json = manner
    _tell(f"Table {table.number}: {table.title}", (head, rows), notes, as_json=as_json)
    if out is not None:
        _save(out, as_csv(head, rows), _page(table, (head, rows), notes, results))


def _tell(title: str, table: tuple[list[str], list[list[str]]], notes: Sequence[str], *, as_json: bool) -> None:
    from visint_lab.trials import grid

    if as_json:
        print(grid.as_json({title: table}, notes))
        return
    print(f"{title}\n")
    print(grid.aligned(*table))
    print("\n" + "\n".join(f"* {note}" for note in notes))


def _page(
    table: ImprovementTable,
    grid: tuple[list[str], list[list[str]]],
    notes: Sequence[str],
    results: Sequence[RowResult],
) -> str:
    from visint_lab.trials import page

    title = f"Table {table.number}: {table.title}"
    parts = [page.table(*grid), page.listed(notes)]
    for result in results:
        parts += [f"<h2>{result.row.label}</h2>", page.gallery(_pictures(result))]
    return page.page(title, parts)


def _pictures(result: RowResult) -> dict[str, Array]:
    from visint.io import srgb_from_linear
    from visint_lab.trials import page

    outcome = result.outcomes[0]
    truth = outcome.pair.truth
    shown = {"left": srgb_from_linear(outcome.pair.left), "right": srgb_from_linear(outcome.pair.right)}
    shown["true depth"] = page.shown_depth(truth.depth, truth.depth)
    shown["true normals"] = page.shown_normals(truth.normals, truth.normals)
    for name, found in outcome.maps.items():
        shown[f"{name}: depth"] = page.shown_depth(found.depth, truth.depth)
        shown[f"{name}: normals"] = page.shown_normals(found.normals, truth.normals)
    return shown


def _save(out: Path, text: str, html: str) -> None:
    from visint.io import make_folder, write_text

    make_folder(out)
    write_text(out / "table.csv", text)
    write_text(out / "table.html", html)
    print((out / "table.html").resolve(), file=sys.stderr)


def _times(number: str, size: int, out: Path | None, *, as_json: bool) -> None:
    from visint_lab.trials import page
    from visint_lab.trials.grid import as_csv
    from visint_lab.trials.published import TIMES
    from visint_lab.trials.timing import time_rows

    table = TIMES[number]
    head, rows, notes = time_rows(table, size)
    _tell(f"Table {number}: {table.title}", (head, rows), notes, as_json=as_json)
    if out is not None:
        parts = [page.table(head, rows), page.listed(notes)]
        _save(out, as_csv(head, rows), page.page(f"Table {number}: {table.title}", parts))
