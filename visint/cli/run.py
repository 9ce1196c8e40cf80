"""visint run: a graph on files, its results into a folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visint.errors import UsageError

if TYPE_CHECKING:
    from visint.graph import Graph
    from visint.results import Result, Source

__all__ = ["EXAMPLES", "command"]

EXAMPLES = (
    "Examples: visint run stereo_sgm --left l.png --right r.png --calib calib.txt --out out;  "
    "visint run mine.yaml --in image=a.png --out out --set match.window=7;  visint run out/run.json --out again"
)


def command(  # noqa: PLR0913, PLR0917 - the options of a command line are many, and typer reads them here
    graph: Annotated[str, typer.Argument(help="A graph file, a shipped graph, or a run.json.")],
    out: Annotated[Path, typer.Option(help="The folder for the results: new, empty, or a former run.")],
    left: Annotated[str, typer.Option(help="The left (reference) image.")] = "",
    right: Annotated[str, typer.Option(help="The right image.")] = "",
    calib: Annotated[str, typer.Option(help="The calibration file (Middlebury calib.txt).")] = "",
    light: Annotated[str, typer.Option(help="Direction to a distant light, x,y,z.")] = "",
    light_at: Annotated[str, typer.Option(help="Position of a light, x,y,z, in the baseline's unit.")] = "",
    disparity_range: Annotated[str, typer.Option(help="Search range a,b in pixels.")] = "",
    in_: Annotated[list[str] | None, typer.Option("--in", help="NAME=PATH, any input; repeatable.")] = None,
    gamma: Annotated[
        float | None, typer.Option(help="Exponent of the images; 1 is linear. Default: sRGB for 8 bits.")
    ] = None,
    set_: Annotated[list[str] | None, typer.Option("--set", help="NODE.PARAM=VALUE.")] = None,
    without: Annotated[list[str] | None, typer.Option(help="A spoke to leave out.")] = None,
    control: Annotated[str, typer.Option(help="One of the graph's controls.")] = "",
    stop_after: Annotated[str, typer.Option(help="The node to stop after.")] = "",
    start: Annotated[str, typer.Option("--from", help="A former run whose map to start from.")] = "",
    seed: Annotated[int, typer.Option(help="Seed of random numbers.")] = 0,
    threads: Annotated[int, typer.Option(min=1, help="Nodes that may run side by side.")] = 1,
    trace: Annotated[str, typer.Option(help="A file for the timeline, in Chrome's trace format.")] = "",
    force: Annotated[bool, typer.Option("--force", help="Take a folder that holds other things.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="What was written, as JSON on stdout.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Say nothing but errors.")] = False,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Say what each node took.")] = False,
) -> None:
    """Run a graph on files; depth, normals, report and record go into a folder."""
    from visint import io
    from visint.cli.again import former
    from visint.engine import Options
    from visint.graph import alter, load

    given = _sources(locals())
    if Path(graph).name == "run.json":
        bound, sources, seed = former(Path(graph))
        sources |= given
    else:
        bound, sources = load(graph), given
    bound = alter(bound, settings=_settings(set_), without=without or (), control=control or None)
    io.OutputFolder(out, force=force)  # refused now rather than after the work
    options = Options(seed=seed, threads=threads, stop_after=stop_after or None, start=_start(start))
    result = _run(bound, sources, options, quiet=quiet, trace=trace)
    files = result.save(out, force=force, sources=sources)
    _tell(result, out, files, as_json=as_json, quiet=quiet, verbose=verbose)


def _sources(given: dict[str, Any]) -> dict[str, Source]:
    from visint.results import Source

    gamma = given["gamma"]
    sources: dict[str, Source] = {}
    for name in ("left", "right"):
        if given[name]:
            sources[name] = Source((_absolute(given[name]),), gamma=gamma)
    if given["calib"] or given["disparity_range"]:
        paths = (_absolute(given["calib"]),) if given["calib"] else ()
        sources["camera"] = Source(paths, given["disparity_range"])
    if given["light"] and given["light_at"]:
        raise UsageError.of("VI701", "--light and --light-at exclude each other")
    if given["light"] or given["light_at"]:
        sources["light"] = Source((), given["light"] or f"at {given['light_at']}")
    for pair in given["in_"] or ():
        name, path = _pair(pair, "--in NAME=PATH")
        before = sources.get(name, Source())
        sources[name] = Source((*before.paths, _absolute(path)), gamma=gamma)
    return sources


def _absolute(path: str) -> str:
    return str(Path(path).absolute())


def _pair(text: str, wanted: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise UsageError.of("VI701", f"{text!r} is not of the form {wanted}")
    return name, value


def _settings(given: list[str] | None) -> dict[str, Any]:
    """``node.param=value``; values are read as in a graph file."""
    from visint.graph.read import parse_value

    pairs = (_pair(text, "--set NODE.PARAM=VALUE") for text in given or ())
    return {key: parse_value(value) for key, value in pairs}


def _start(folder: str) -> dict[str, Any]:
    """The fields of the map that a former run left: depth, and boundaries if it has them."""
    from visint import io

    if not folder:
        return {}
    place = Path(folder)
    fields = {"depth": ("depth.pfm", "Depth"), "boundaries": ("boundaries.png", "Boundaries")}
    return {
        name: io.read(place / file, kind)
        for name, (file, kind) in fields.items()
        if name == "depth" or (place / file).exists()
    }


def _run(graph: Graph, sources: dict[str, Source], options: Any, *, quiet: bool, trace: str) -> Result:
    from dataclasses import replace

    import visint
    from visint import io
    from visint.cli.interrupt import interruptible
    from visint.cli.progress import progress
    from visint.engine.profile import Profile
    from visint.engine.sources import read_sources

    profile = Profile()
    with interruptible() as cancel, progress(quiet=quiet) as shown:
        observers = [*([shown] if shown else []), *([profile] if trace else [])]
        values = read_sources(graph, sources)
        options = replace(options, observers=tuple(observers), cancel=cancel)
        result = visint.run(graph, values, options=options)
    if trace:
        io.write_text(trace, json.dumps(profile.chrome()))
    return result


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
