"""Fit parameters on training scenes, and report on validation scenes that the fit never saw."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from visint_lab.tuning.table import Sample
    from visint_lab.tuning.validation import Verdict

NAMES = {"lit": ("plate", "whole", "loose", "shaded", "bright", "round"), "dark": ("plate", "loose")}
HEAD = [
    "",
    "surface",
    "scenes",
    "D %",
    "S %",
    "hidden D %",
    "D worse",
    "S worse",
    "worst D %",
    "σ depth %",
    "σ normals %",
]

EXAMPLES = (
    "Examples: visint tune stereo_sgm --param match.speckle=50,100,200 --out tuned;  "
    "visint tune joint --choice --scenes 31000:1 --out tuned"
)


def command(  # noqa: PLR0913, PLR0917 - the options of a command line are many, and typer reads them here
    graph: Annotated[str, typer.Argument(help="A graph's name or path.")],
    param: Annotated[
        list[str] | None, typer.Option(help="node.param=v1,v2,…: values to choose among; repeat for more.")
    ] = None,
    choice: Annotated[bool, typer.Option(help="Fit the choice among the joint estimate's candidates.")] = False,
    scenes: Annotated[str, typer.Option(help="Training scenes as FIRST_SEED:ROUNDS of 42.")] = "31000:1",
    validate: Annotated[str, typer.Option(help="Validation scenes likewise; 0:0 is none.")] = "910000:1",
    table: Annotated[Path | None, typer.Option(help="Fit the choice from this recorded table.")] = None,
    size: Annotated[int, typer.Option(min=48, max=1024, help="Rows and columns of the scenes.")] = 256,
    out: Annotated[
        Path | None, typer.Option(help="Folder for what was learned, its table and the report.")
    ] = None,
) -> None:
    """Fit parameters on training scenes, and report on validation scenes that the fit never saw."""
    from visint_lab.trials.systems import SystemVariant

    learned: dict[str, Any] = {}
    if choice:
        learned["choice"] = _choice(scenes, table, size, out)
    settings = _best(graph, param or [], scenes, size)
    learned["parameters"] = settings
    print(f"chosen: {settings or 'nothing to choose'}", file=sys.stderr)
    if out is not None:
        _write(out / "learned.json", learned)
    if not validate.endswith(":0"):
        _validated(SystemVariant(graph), settings, validate, size, out)


def _drawn(asked: str) -> list[tuple[str, int]]:
    from visint.errors import UsageError
    from visint_lab.tuning.conditions import drawn

    first, _, rounds = asked.partition(":")
    if not (first.isdigit() and rounds.isdigit()):
        raise UsageError.of("VI701", f"scenes are FIRST_SEED:ROUNDS, not {asked!r}", write="--scenes 31000:1")
    return list(drawn(int(first), int(rounds)))


def _choice(scenes: str, table: Path | None, size: int, out: Path | None) -> dict[str, Any]:
    """The choice among candidates, with a light and without one."""
    from visint_lab.tuning.fit import fitted
    from visint_lab.tuning.table import written

    found = {}
    for which, names in NAMES.items():
        samples = _samples(which, scenes, table, size)
        if out is not None:
            _write(out / f"table_{which}.json", written(samples))
        fit = fitted(samples)
        found[which] = fit.told(names)
        _tell_fit(which, samples, fit)
    if out is not None:
        _write(out / "choice.json", found)
    return found


def _samples(which: str, scenes: str, table: Path | None, size: int) -> Sequence[Sample]:
    from visint.io import read_json
    from visint_lab.tuning.table import gathered, samples_in

    if table is not None:
        return samples_in(read_json(table)[which])
    return list(gathered(_drawn(scenes), size, which == "lit"))


def _tell_fit(which: str, samples: Sequence[Sample], fit: Any) -> None:
    import numpy as np

    middle, worst = np.median(fit.held_out, axis=0), (fit.held_out < -2).sum(axis=0)
    print(
        f"{which}: {len(samples)} scenes; left out in turn, the blend gains at least D {middle[0]:.0f} % and "
        f"S {middle[1]:.0f} % in the median, and is worse in {worst[0]} and {worst[1]}; caution {fit.caution}, "
        f"warmth {fit.warmth}"
    )


def _best(graph: str, asked: Sequence[str], scenes: str, size: int) -> dict[str, float]:
    """The values, one parameter after the other, with the best median D + S over the training scenes."""
    settings: dict[str, float] = {}
    for one in asked:
        name, _, values = one.partition("=")
        worth = {
            value: _worth(graph, {**settings, name: value}, scenes, size)
            for value in map(float, values.split(","))
        }
        for value, gain in worth.items():
            print(f"{name} = {value}: {gain:.1f}", file=sys.stderr)
        settings[name] = max(worth, key=lambda value: worth[value])
    return settings


def _worth(graph: str, settings: Mapping[str, float], scenes: str, size: int) -> float:
    from statistics import median

    from visint_lab.trials.systems import SystemVariant, baseline_of
    from visint_lab.tuning.validation import verdicts

    variant = SystemVariant(graph, settings=tuple(settings.items()))
    found = [
        one
        for one in verdicts(_drawn(scenes), size, [variant], baseline_of(graph))
        if one.system == str(variant)
    ]
    return median(one.depth for one in found) + median(one.shape for one in found)


def _validated(system: Any, settings: Mapping[str, float], asked: str, size: int, out: Path | None) -> None:
    """Prints the report on scenes of other seeds, the controls beside the system."""
    from dataclasses import replace

    from visint_lab.trials.systems import baseline_of, controls_of
    from visint_lab.tuning.validation import verdicts

    systems = [replace(system, settings=tuple(settings.items())), *controls_of(system.graph)]
    found = []
    for one in verdicts(_drawn(asked), size, systems, baseline_of(system.graph)):
        print(f"{one.scene}: {one.system}: D {one.depth:.0f} S {one.shape:.0f}", file=sys.stderr)
        found.append(one)
    _report(found, out)


def _report(found: Sequence[Verdict], out: Path | None) -> None:
    from dataclasses import asdict

    from visint.io import make_folder, write_text
    from visint_lab.trials.grid import aligned, as_csv, number
    from visint_lab.tuning.validation import table

    rows = [[*row[:2], *(number(cell, 0) for cell in row[2:])] for row in table(found)]
    print(aligned(HEAD, rows))
    if out is not None:
        make_folder(out)
        write_text(out / "validation.csv", as_csv(HEAD, rows))
        _write(out / "scenes.json", [asdict(one) for one in found])


def _write(path: Path, values: Any) -> None:
    from json import dumps

    from visint.io import make_folder, write_text

    make_folder(path.parent)
    write_text(path, dumps(values) + "\n")
