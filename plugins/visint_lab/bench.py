"""Hold systems and peers against each other: quality, time and memory in one table."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from visint_lab.trials.contest import Heat, Standing

STEREO = ("bad1", "bad2", "mae", "bad2_low", "density", "ause", "cpu", "peak_mb")
RUN = ("rmse", "s", "median", "angle", "rmse_visible", "s_visible", "ause", "cpu", "peak_mb")
PERCENT = ("bad1", "bad2", "bad2_low", "density")

EXAMPLES = (
    "Examples: visint bench stereo --on ../data --out bench;  "
    "visint bench run --on a --size 256;  "
    "visint bench engine;  "
    "visint bench start"
)


def command(  # noqa: PLR0913, PLR0917 - the options of a command line are many, and typer reads them here
    what: Annotated[
        str,
        typer.Argument(
            help="stereo: disparity on pairs; run: depth and shape on scenes; engine: what nodes and turns "
            "cost; start: how long it takes to begin."
        ),
    ],
    on: Annotated[
        list[str] | None,
        typer.Option(help="Scene names or their beginnings (a, b/mozart), or folders of pairs."),
    ] = None,
    system: Annotated[
        list[str] | None, typer.Option(help="Graphs; the first is what others are held to.")
    ] = None,
    peer: Annotated[list[str] | None, typer.Option(help="Peers by name; all, or none.")] = None,
    size: Annotated[int, typer.Option(min=32, max=2048, help="Rows and columns of rendered scenes.")] = 512,
    out: Annotated[Path | None, typer.Option(help="Folder for bench.csv, scenes.csv and bench.html.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
) -> None:
    """Hold systems and peers against each other: quality, time and memory in one table."""
    from visint.errors import UsageError
    from visint_lab.trials.contest import entrants, heats, standings
    from visint_lab.trials.gathering import gathered

    if what in ("engine", "start"):
        from visint_lab.engines import bench

        bench.engines(peer, out) if what == "engine" else bench.start()
        return
    if what not in ("stereo", "run"):
        raise UsageError.of("VI701", f"there is no bench {what!r}", choices="stereo, run, engine, start")
    field = entrants(system or ["stereo_sgm"], _peers(peer))
    found: list[Heat] = []
    for heat in heats(gathered(on, what, size), field):
        print(_line(heat), file=sys.stderr)
        found.append(heat)
    decides = "bad2" if what == "stereo" else "rmse"
    _tell(what, found, standings(found, decides), out, as_json=as_json)


def _peers(asked: list[str] | None) -> tuple[str, ...]:
    """All that are asked for; without a word all that are installed."""
    from visint.errors import UsageError
    from visint_lab.peers import NAMES, available

    if asked is None:
        try:
            available()
        except UsageError as error:
            print(error, file=sys.stderr)
            return ()
    if asked in (None, ["all"]):
        return NAMES
    return () if asked == ["none"] else tuple(asked or ())


def _line(heat: Heat) -> str:
    if heat.failure:
        return f"{heat.pair}: {heat.entrant}: {heat.failure}"
    shown = {key: heat.scores[key] for key in ("bad2", "rmse", "cpu") if key in heat.scores}
    return f"{heat.pair}: {heat.entrant}: " + ", ".join(f"{key} {value:.3g}" for key, value in shown.items())


def _tell(
    what: str, found: Sequence[Heat], order: Sequence[Standing], out: Path | None, *, as_json: bool
) -> None:
    from visint_lab.trials import grid

    keys = STEREO if what == "stereo" else RUN
    decides = keys[1] if what == "stereo" else keys[0]
    head = ["", *(_head(key) for key in keys), f"{decides} worse"]
    rows = [_row(one, keys) for one in order]
    first = order[0].entrant
    note = f"Medians over {order[0].pairs} pairs; worse: pairs where {decides} is worse than {first}'s."
    told = grid.as_json({what: (head, rows)}, [note]) if as_json else grid.aligned(head, rows) + "\n\n" + note
    print(told)
    if out is not None:
        _save(out, (head, rows, note), found, (order, decides))


def _head(key: str) -> str:
    return f"{key} %" if key in PERCENT else {"cpu": "CPU s", "peak_mb": "peak MB"}.get(key, key)


def _row(one: Standing, keys: Sequence[str]) -> list[str]:
    return [one.entrant, *(_cell(one.medians.get(key), key) for key in keys), f"{one.worse}/{one.pairs}"]


def _cell(value: float | None, key: str) -> str:
    from visint_lab.trials.grid import number

    if value is not None and key in PERCENT:
        return number(100 * value)
    return number(value, 0 if key == "peak_mb" else 3)


def _save(
    out: Path,
    grid: tuple[list[str], list[list[str]], str],
    found: Sequence[Heat],
    plotted: tuple[Any, str],
) -> None:
    from visint.io import make_folder, write_text
    from visint_lab.trials import page
    from visint_lab.trials.grid import as_csv
    from visint_lab.trials.plot import quality_and_time

    head, rows, note = grid
    make_folder(out)
    write_text(out / "bench.csv", as_csv(head, rows))
    keys = list(dict.fromkeys(key for heat in found for key in heat.scores))
    scenes = [[h.pair, h.entrant, *(f"{h.scores.get(k, float('nan')):.6g}" for k in keys)] for h in found]
    write_text(out / "scenes.csv", as_csv(["pair", "entrant", *keys], scenes))
    parts = [page.table(head, rows), page.listed([note]), quality_and_time(*plotted, label=plotted[1])]
    write_text(out / "bench.html", page.page("Quality, time and memory", parts))
    print((out / "bench.html").resolve(), file=sys.stderr)
