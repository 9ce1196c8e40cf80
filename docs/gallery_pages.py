"""Makes the gallery of graphs: each shipped one drawn from its file, and what it gives on a scene."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from reference_pages import write

import visint
from visint import io
from visint.graph import drawing
from visint.registry import installed
from visint.results.report.embed import reduced
from visint.results.report.maps import Map, is_map, picture

__all__ = ["write_gallery"]

SIZE = 96
"""Rows and columns of the scene: small, for every graph is run each time the docs are built."""

SCENES = {"one_view": "a/sphere/lambertian+2%"}
"""Graphs for which another scene than the demonstration's is right."""


def write_gallery(folder: Path) -> None:
    """Writes ``graphs.md`` and its pictures into ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "graphs.md", "\n".join(_page(folder)) + "\n")


def _page(folder: Path) -> Iterator[str]:
    yield "# Shipped graphs\n"
    yield "Drawn from their files, as `visint show NAME --html` does, and run when this page was"
    yield f"built: the demonstration scene of the lab at {SIZE} × {SIZE} pixels (a sphere of one albedo for"
    yield "`one_view`). Pictures of this size show what a graph gives, not how good it is."
    yield "\n```{raw} html\n<style>.visint-graph{max-width:100%;height:auto}</style>\n```"
    for name, path in sorted(installed().graphs().items()):
        yield from _graph(name, path, folder)


def _graph(name: str, path: Path, folder: Path) -> Iterator[str]:
    graph = visint.load(path)
    yield f"\n## {name}\n\n{graph.spec.about}\n"
    svg = re.sub(r"\n\s*\n", "\n", drawing.to_svg(graph.spec))  # Markdown ends raw HTML at an empty line
    yield f'```{{raw}} html\n<div style="overflow-x:auto">{svg}</div>\n```\n'
    result = visint.run(graph, _inputs(graph, name))
    shown = {port: value for port, value in result.items() if is_map(value)}
    strip = np.hstack([_tile(result.kinds[port], value) for port, value in shown.items()])
    io.write_bytes(folder / f"graph_{name}.png", io.encode_png(strip))
    yield f"![{', '.join(shown)}](graph_{name}.png)\n"
    yield ", ".join(f"`{port}`" for port in shown) + ", from left to right."
    yield f"\n```yaml\n{path.read_text().strip()}\n```"


def _tile(kind: str, value: Any) -> Any:
    tile = reduced(np.ascontiguousarray(picture(Map("", kind, value))[..., :3]), SIZE)
    return np.pad(tile, ((0, 0), (0, 4), (0, 0)), constant_values=255)


def _inputs(graph: visint.Graph, name: str) -> dict[str, Any]:
    from visint_lab.render.rendering import render
    from visint_lab.scenes import scene
    from visint_lab.scenes.demonstration import sphere_before_plane

    found = scene(SCENES[name], size=SIZE) if name in SCENES else sphere_before_plane(SIZE, 0)
    pair = render(found)
    offered = {"left": pair.left, "right": pair.right, "camera": pair.camera, "light": pair.light}
    offered |= {"image": pair.left}
    return {port: offered[port] for port in graph.inputs if port in offered}
