"""``visint demo``: a rendered scene, whose truth is known, through the main graph."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from visint import Graph
    from visint_lab.render.rendering import Rendering

EXAMPLES = "Examples: visint demo;  visint demo --size 256 --out sphere;  visint run demo/run.json --out again"

GRAPH = "joint"
"""The graph that the demonstration runs: the best system there is."""


def command(
    out: Annotated[Path, typer.Option(help="Folder for the results; empty, new or an earlier run.")] = Path(
        "demo"
    ),
    size: Annotated[int, typer.Option(min=64, max=2048, help="Rows and columns of the rendered images.")] = 512,
    graph: Annotated[str, typer.Option(help="A shipped graph or a path.")] = GRAPH,
    seed: Annotated[int, typer.Option(help="Of the textures.")] = 0,
    force: Annotated[
        bool, typer.Option("--force", help="Write into a folder that holds something else.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
) -> None:
    """Render a textured sphere before a plane, reconstruct it, and say where the report is."""
    import visint
    from visint.io import OutputFolder
    from visint_lab.render.rendering import render
    from visint_lab.scenes.demonstration import sphere_before_plane

    OutputFolder(out, force=force)  # refuses before the work, not after it
    bound = visint.load(graph)
    pair = render(sphere_before_plane(size, seed))
    files = _written(pair, out.with_name(f"{out.resolve().name}-pair"))
    given = _wanted(bound, pair, files)
    result = visint.run(bound, given, options=visint.Options(attribution=True))
    result.save(out, force=force, sources={name: files[name] for name in files if name in given})
    said = comparison(result["depth"], pair)
    if as_json:
        told = {"out": str(out), "seconds": result.seconds, "against_the_truth": said}
        print(json.dumps(told | {"warnings": [warned._asdict() for warned in result.warnings]}, indent=1))
        return
    print(said, file=sys.stderr)
    print((out / "report.html").resolve())


def _written(pair: Rendering, folder: Path) -> dict[str, Path]:
    """The pair and its calibration as files, by the inputs that they are: so that the run can be done again."""
    from visint.io import encode_pfm, make_folder, write_bytes, write_text

    make_folder(folder)
    camera = pair.camera
    files = {"left": folder / "left.pfm", "right": folder / "right.pfm", "camera": folder / "calib.txt"}
    write_bytes(files["left"], encode_pfm(pair.left))
    write_bytes(files["right"], encode_pfm(pair.right))
    matrix = f"[{camera.focal_length} 0 {{}}; 0 {camera.focal_length} {camera.cy}; 0 0 1]"
    low, high = camera.disparity_range or (0, camera.width / 4)
    lines = {
        "cam0": matrix.format(camera.cx), "cam1": matrix.format(camera.cx + camera.doffs),
        "doffs": camera.doffs, "baseline": camera.baseline, "width": camera.width, "height": camera.height,
        "vmin": low, "vmax": high,
        "unit": camera.unit,
    }  # fmt: skip
    write_text(files["camera"], "".join(f"{key}={value}\n" for key, value in lines.items()))
    return files


def _wanted(graph: Graph, pair: Rendering, files: Mapping[str, Path]) -> dict[str, Any]:
    """What the graph takes of the scene, read from the files that were written.

    The light only if the graph cannot do without: a texture before a wall tells nothing of it.
    """
    from visint.io import read_camera, read_image

    offered = {
        "left": read_image(files["left"]),
        "right": read_image(files["right"]),
        "camera": read_camera(files["camera"]),
        "light": pair.light,
    }
    if "light" in graph.inputs and graph.inputs["light"].optional:
        del offered["light"]
    return {name: value for name, value in offered.items() if name in graph.inputs}


def comparison(depth: Any, pair: Rendering) -> str:
    """One sentence: how ``depth`` (H, W) compares with the pair's truth."""
    import numpy as np

    from visint.fields.geometry import disparity_from_depth

    truth = pair.truth
    known = np.isfinite(depth) & truth.visible
    if not known.any():
        return "nothing was reconstructed"
    median = np.median(np.abs(depth - truth.depth)[known])
    wrong = ~(np.abs(disparity_from_depth(depth, pair.camera) - truth.disparity) <= 2.0)
    return (
        f"against the truth: median depth error {median / np.median(truth.depth[known]):.2%}, "
        f"bad-2.0 {wrong[truth.visible].mean():.1%} of the pixels that both cameras see"
    )
