"""Show what each cue adds: a graph as it is, by its controls, without each spoke."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    import visint
    from visint_lab.datasets import Pair
    from visint_lab.trials.contribution import Contribution
    from visint_lab.trials.reconstruction import Reconstruction

KEYS = ("rmse", "s", "median", "bad1", "bad2", "mae", "ause", "seconds")

EXAMPLES = (
    "Examples: visint ablate uniform_bayesian a/sphere/lambertian+2%;  "
    "visint ablate mine.yaml PAIR --truth DIR --out ablation"
)


def command(
    graph: Annotated[str, typer.Argument(help="A graph's name or path.")],
    pair: Annotated[str, typer.Argument(help="A folder with a pair and its truth, or a scene's name.")],
    truth: Annotated[Path | None, typer.Option(help="Another folder to take the truth from.")] = None,
    size: Annotated[int, typer.Option(min=32, max=2048, help="Rows and columns of a rendered scene.")] = 512,
    out: Annotated[Path | None, typer.Option(help="Folder for ablation.csv and contributions.csv.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
) -> None:
    """Show what each cue adds: a graph as it is, by its controls, without each spoke.

    Under the scores stands what each cue contributes: the percentage of each error that it takes away,
    negative where it does harm, and the mean share of the depth that it decided. A control is a cue whose
    amplitude is zero, all else kept; it is set beside the cue whose name it bears.
    """
    from visint_lab.trials import grid
    from visint_lab.trials.contribution import contributions
    from visint_lab.trials.grid import as_csv, number
    from visint_lab.trials.reconstruction import scored
    from visint_lab.trials.systems import SystemVariant, baseline_of, controls_of, cues_of, reconstruct

    shown, light = _pair(pair, truth, size)
    stereo = SystemVariant(baseline_of(graph))
    variants = [SystemVariant(graph), *controls_of(graph), *cues_of(graph)]
    variants += [] if stereo in variants else [stereo]
    made: dict[str, Reconstruction] = {}
    for variant in variants:
        print(variant, file=sys.stderr)
        made[str(variant)] = reconstruct(variant, shown, light, attribution=variant == variants[0])
    found = {name: {**scored(one, shown), "seconds": one.cost.wall} for name, one in made.items()}
    keys = [key for key in KEYS if any(key in scores for scores in found.values())]
    rows = [[name, *(number(scores.get(key), 3) for key in keys)] for name, scores in found.items()]
    own = contributions(variants[0], variants, found, made[str(variants[0])].shares)
    if as_json:
        print(grid.as_json({"scores": (["", *keys], rows), "contributions": _contributed(own)}))
    else:
        _tell(graph, (["", *keys], rows), own)
    if out is not None:
        _save(out, {"ablation.csv": as_csv(["", *keys], rows), "contributions.csv": as_csv(*_contributed(own))})


def _tell(graph: str, scores: tuple[list[str], list[list[str]]], own: list[Contribution]) -> None:
    from visint_lab.trials.grid import aligned

    print(aligned(*scores))
    if own:
        print(f"\nWhat {graph} gains by a cue, % of each error; and how much of the depth the cue decided")
        print(aligned(*_contributed(own)))
    else:
        print(f"\n{graph} names no controls and has no spokes: there is nothing to leave out.")


def _contributed(own: list[Contribution]) -> tuple[list[str], list[list[str]]]:
    """The head and the rows of the table of contributions."""
    from visint_lab.trials.grid import number

    keys = list(own[0].gains) if own else []
    rows = [[one.taken, *(number(one.gains.get(key)) for key in keys), number(100 * one.share)] for one in own]
    return ["", *keys, "decided, %"], rows


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


def _save(out: Path, tables: dict[str, str]) -> None:
    from visint.io import make_folder, write_text

    make_folder(out)
    for name, text in tables.items():
        write_text(out / name, text)
        print((out / name).resolve(), file=sys.stderr)
