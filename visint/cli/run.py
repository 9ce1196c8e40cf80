"""visint run: a graph on files, its results into a folder."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visint.cli.complete import graphs
from visint.cli.given import Given, settings
from visint.cli.interrupt import interruptible, undoable
from visint.cli.progress import progress
from visint.errors import InputError, OutputError, UsageError

if TYPE_CHECKING:
    from visint.cli.again import Former
    from visint.engine import Options
    from visint.graph import Graph
    from visint.results import Result, Source

__all__ = ["EXAMPLES", "command"]

EXAMPLES = (
    "Examples: visint run stereo_sgm --left l.png --right r.png --calib calib.txt --out out;  "
    "visint run mine.yaml --in image=a.png --out out --set match.speckle=50;  "
    "visint run out/run.json --out again;  "
    "visint run stereo --left l.png --right r.png --calib calib.txt --out other --against out"
)


def command(  # noqa: PLR0913, PLR0917 - the options of a command line are many, and typer reads them here
    graph: Annotated[
        str, typer.Argument(help="A graph file, a shipped graph, or a run.json.", autocompletion=graphs)
    ],
    out: Annotated[
        Path, typer.Option(readable=False, help="The folder for the results: new, empty, or a former run.")
    ],
    left: Annotated[str, typer.Option(help="The left (reference) image of the pair.")] = "",
    right: Annotated[str, typer.Option(help="The right image, of the same size.")] = "",
    calib: Annotated[
        str,
        typer.Option(
            help="The calibration: Middlebury calib.txt, OpenCV stereo YAML or KITTI. "
            "A pair that is not rectified is, by it."
        ),
    ] = "",
    light: Annotated[str, typer.Option(help="Direction to a distant light, x,y,z.")] = "",
    light_at: Annotated[str, typer.Option(help="Position of a light, x,y,z, in the baseline's unit.")] = "",
    disparity_range: Annotated[
        str,
        typer.Option(
            help="Search range a,b in pixels, before that of --calib; without --calib, depth is relative."
        ),
    ] = "",
    in_: Annotated[
        list[str] | None,
        typer.Option("--in", help="NAME=PATH, any input; repeatable, also for a list; numbers as .npy."),
    ] = None,
    gamma: Annotated[
        float | None, typer.Option(help="Exponent of the images; 1 is linear. Default: sRGB for 8 bits.")
    ] = None,
    set_: Annotated[list[str] | None, typer.Option("--set", help="NODE.PARAM=VALUE; repeatable.")] = None,
    without: Annotated[
        list[str] | None, typer.Option(help="A spoke of the hub to leave out; repeatable.")
    ] = None,
    control: Annotated[str, typer.Option(help="One of the graph's controls.")] = "",
    stop_after: Annotated[
        str, typer.Option(help="The node to stop after; what it gives is written as NODE_PORT.")
    ] = "",
    start: Annotated[str, typer.Option("--from", help="A former run whose map to start from.")] = "",
    seed: Annotated[int | None, typer.Option(help="Seed of random numbers.  [default: 0]")] = None,
    threads: Annotated[int, typer.Option(min=1, help="Nodes that may run side by side.")] = 1,
    trace: Annotated[str, typer.Option(help="A file for the timeline, in Chrome's trace format.")] = "",
    rerun: Annotated[
        str, typer.Option(help="A file for the Rerun viewer: maps by level and turn; needs the extra.")
    ] = "",
    against: Annotated[
        str, typer.Option(help="The folder of another run; the report compares this one with it.")
    ] = "",
    force: Annotated[bool, typer.Option("--force", help="Take a folder that holds other things.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="What was written, as JSON on stdout.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Say nothing but errors.")] = False,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Say what each node took.")] = False,
) -> None:
    """Run a graph on files; depth, normals, report and record go into a folder."""
    from visint.cli.again import former
    from visint.cli.beside import Beside
    from visint.cli.remarks import remarks
    from visint.engine import Options
    from visint.graph import alter, load

    typed = Given(left, right, calib, light, light_at, disparity_range, tuple(in_ or ()), gamma)
    before = former(Path(graph)) if Path(graph).name == "run.json" else None
    bound = before.graph if before else load(graph)
    bound = alter(bound, settings=settings(set_ or []), without=without or (), control=control or None)
    given = typed.sources(bound)
    sources = before.sources(given) if before else given
    _refuse_now(out, (trace, rerun), against, force=force)
    beside = Beside(bound, trace, rerun)
    options = Options(
        seed=seed if seed is not None else before.seed if before else 0,
        threads=threads,
        stop_after=stop_after or (before.stop_after if before else "") or None,
        start=_start(bound, start, before),
        observers=beside.observers,
        attribution=before is None or before.attribution,
    )
    said: list[tuple[str, str]] = []
    result = _run(bound, sources, options, said, quiet=quiet)
    result.warnings[:0] = remarks(result, said, before.changed(result, given) if before else ())
    with undoable():
        files = result.save(out, force=force, sources=sources, against=against or None)
        beside.write()
    _tell(result, out, files, as_json=as_json, quiet=quiet, verbose=verbose)


def _refuse_now(out: Path, others: tuple[str, ...], against: str, *, force: bool) -> None:
    """What cannot be written, and another run that cannot be read, is refused before the work."""
    from visint import io
    from visint.results.against import read_against

    if against:
        read_against(against)
    io.OutputFolder(out, force=force)
    place = out.absolute()
    _writable(next(folder for folder in (place, *place.parents) if folder.exists()))
    for home in {Path(path).absolute().parent for path in others if path} - {place}:
        _writable(home)


def _writable(folder: Path) -> None:
    if not folder.is_dir():
        raise OutputError.of("VI601", "does not exist; create it first", where=str(folder))
    if not os.access(folder, os.W_OK | os.X_OK):
        found = "cannot be written to; wants a folder that you may write to"
        raise OutputError.of("VI601", found, where=str(folder))


def _start(graph: Graph, folder: str, before: Former | None) -> dict[str, Any]:
    """The fields of the map that a former run left: depth, and boundaries if it has them."""
    from visint import io

    if not folder:
        if before and before.start:
            raise InputError.of("VI304", "that run started from a former map", write="--from DIR")
        return {}
    if graph.spec.hub is None:
        raise UsageError.of("VI701", f"--from starts a map, and the graph {graph.name!r} has no hub")
    place = Path(folder)
    fields = {"depth": ("depth.pfm", "Depth"), "boundaries": ("boundaries.png", "Boundaries")}
    return {
        name: io.read(place / file, kind)
        for name, (file, kind) in fields.items()
        if name == "depth" or (place / file).exists()
    }


def _run(
    graph: Graph,
    sources: Mapping[str, Source],
    options: Options,
    said: list[tuple[str, str]],
    *,
    quiet: bool,
) -> Result:
    from dataclasses import replace

    import visint
    from visint.engine.sources import read_sources

    with interruptible() as cancel, progress(quiet=quiet) as shown:
        values = read_sources(graph, sources, lambda name, sentence: said.append((name, sentence)))
        observers = (*options.observers, *([shown] if shown else []))
        return visint.run(graph, values, options=replace(options, observers=observers, cancel=cancel))


def _tell(
    result: Result, out: Path, files: tuple[str, ...], *, as_json: bool, quiet: bool, verbose: bool
) -> None:
    if as_json:
        told = {"out": str(out), "files": list(files), "seconds": result.seconds}
        typer.echo(json.dumps(told | {"warnings": [warned._asdict() for warned in result.warnings]}, indent=1))
    elif not quiet:
        typer.echo(str((out / "report.html").absolute()))
    if quiet:
        return
    for warned in result.warnings:
        typer.echo(f"warning: {warned.node}: {warned.text} [{warned.code}]", err=True)
    if verbose:
        for timing in result.record.timings():
            line = f"{timing.node:24} level {timing.level}  {timing.calls:5} calls  {timing.seconds:8.3f} s"
            typer.echo(line, err=True)
