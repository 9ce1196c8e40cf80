"""``visint demo``: a rendered scene, whose truth is known, through the main graph."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from visint import Graph
    from visint_lab.render.rendering import Rendering

GRAPH = "stereo_sgm"
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
) -> None:
    """Render a textured sphere before a plane, reconstruct it, and say where the report is."""
    import visint
    from visint_lab.render.rendering import render
    from visint_lab.scenes.demonstration import sphere_before_plane

    bound = visint.load(graph)
    pair = render(sphere_before_plane(size, seed))
    result = visint.run(bound, **_wanted(bound, pair))
    result.save(out, force=force)
    print(comparison(result["depth"], pair), file=sys.stderr)
    print((out / "report.html").resolve())


def _wanted(graph: Graph, pair: Rendering) -> dict[str, Any]:
    offered = {"left": pair.left, "right": pair.right, "camera": pair.camera, "light": pair.light}
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
