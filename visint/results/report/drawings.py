"""Drawings that writers make of outputs: SVG files, shown as pictures, so that nothing in them can run."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import TYPE_CHECKING

from visint.results.report.markup import Markup, element

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["MOST_BYTES", "drawing", "drawings"]

MOST_BYTES = 400_000
"""How large a drawing may be, and all of them together twice that; what is more stays a file of its own."""


def drawings(result: Result) -> Mapping[str, bytes]:
    """File name → bytes of each ``.svg`` that writers of the outputs' kinds make; of too large ones none."""
    writers = result.graph.catalog.writers()
    made = {
        file: data
        for name, value in result.outputs.items()
        if (kind := result.kinds[name]) in writers
        for file, data in writers[kind](name, value).items()
    }
    found = {file: data for file, data in made.items() if file.endswith(".svg")}
    room = 2 * MOST_BYTES
    for file, data in found.items():
        fits = len(data) <= min(MOST_BYTES, room)
        found[file] = data if fits else b""
        room -= len(found[file])
    return found


def drawing(file: str, data: bytes) -> Markup:
    """The figure of a drawing.

    As the source of an ``<img>`` an SVG is a picture: a browser runs no script of it, follows no link and
    fetches nothing, whatever it holds. The script lays the reference view beneath.
    """
    name = element("strong", file)
    if not data:
        return element("figure", element("figcaption", name, " too large for the report: open the file"))
    source = "data:image/svg+xml;base64," + base64.b64encode(data).decode()
    picture = element("img", src=source, alt=f"Drawing {file}")
    caption = element("figcaption", name, " drawn by a plugin")
    return element("figure", picture, caption, data_over="fade", class_="drawing")
