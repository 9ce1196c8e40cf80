"""Show what each cue adds: a graph as it is, by its controls, without each spoke."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    import visint
    from visint_lab.datasets import Pair

KEYS = ("rmse", "s", "median", "bad1", "bad2", "mae", "ause", "seconds")


def command(
    graph: Annotated[str, typer.Argument(help="A graph's name or path.")],
    pair: Annotated[str, typer.Argument(help="A folder with a pair and its truth, or a scene's name.")],
    truth: Annotated[Path | None, typer.Option(help="Another folder to take the truth from.")] = None,
    size: Annotated[int, typer.Option(min=32, max=2048, help="Rows and columns of a rendered scene.")] = 512,
    out: Annotated[Path | None, typer.Option(help="Folder for ablation.csv.")] = None,
) -> None:
    """Show what each cue adds: a graph as it is, by its controls, without each spoke."""
    from visint_lab.trials.grid import aligned, as_csv, number
    from visint_lab.trials.systems import SystemVariant, baseline_of, controls_of, cues_of

    shown, light = _pair(pair, truth, size)
    stereo = SystemVariant(baseline_of(graph))
    variants = [SystemVariant(graph), *controls_of(graph), *cues_of(graph)]
    variants += [] if stereo in variants else [stereo]
    found: dict[str, Mapping[str, float]] = {}
    for variant in variants:
        print(variant, file=sys.stderr)
        found[str(variant)] = _scores(variant, shown, light)
    keys = [key for key in KEYS if any(key in scores for scores in found.values())]
    rows = [[name, *(number(scores.get(key), 3) for key in keys)] for name, scores in found.items()]
    print(aligned(["", *keys], rows))
    if len(variants) < 3:
        print(f"\n{graph} names no controls and has no spokes: there is nothing to leave out.")
    if out is not None:
        _save(out, as_csv(["", *keys], rows))


def _scores(variant: object, pair: Pair, light: visint.Light | None) -> Mapping[str, float]:
    from visint_lab.trials.reconstruction import scored
    from visint_lab.trials.systems import SystemVariant, reconstruct

    assert isinstance(variant, SystemVariant)
    found = reconstruct(variant, pair, light)
    return {**scored(found, pair), "seconds": found.cost.wall}


def _pair(name: str, truth: Path | None, size: int) -> tuple[Pair, visint.Light | None]:
    from dataclasses import replace

    from visint.errors import UsageError
    from visint_lab.datasets import pairs_in
    from visint_lab.trials.gathering import gathered

    if truth is not None:
        own, other = (pairs_in(folder)[0].read() for folder in (name, truth))
        return replace(own, disparity=other.disparity, visible=other.visible), None
    found = gathered([name], "run", size)
    if len(found) != 1:
        raise UsageError.of("VI701", f"{name!r} is not one pair with truth", write="--truth FOLDER")
    return found[0]


def _save(out: Path, text: str) -> None:
    from visint.io import make_folder, write_text

    make_folder(out)
    write_text(out / "ablation.csv", text)
    print((out / "ablation.csv").resolve(), file=sys.stderr)
