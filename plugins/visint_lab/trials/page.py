"""Pages: a table with the pictures behind it, in one file that works offline."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np

from visint.arrays import Array

__all__ = ["page", "picture", "shown_depth", "shown_normals", "table"]

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 84rem; padding: 0 1rem; }
table { border-collapse: collapse; margin: 1rem 0; }
th, td { padding: .25rem .7rem; text-align: right; border-bottom: 1px solid #8884; }
th:first-child, td:first-child { text-align: left; }
figure { display: inline-block; margin: 0 .6rem .8rem 0; } figcaption { font-size: .8rem; color: #777; }
img { width: 13rem; image-rendering: auto; background: #000; border-radius: 3px; }
@media (prefers-color-scheme: dark) { body { background: #16181c; color: #ddd; } }
"""


def page(title: str, parts: Sequence[str]) -> str:
    """The whole file; ``parts`` are HTML."""
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<link rel="icon" href="data:,"><style>{_STYLE}</style></head>\n'
        f"<body><h1>{escape(title)}</h1>\n{body}\n</body></html>\n"
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table as HTML."""
    lines = [_line("th", head), *(_line("td", row) for row in rows)]
    return "<table>" + "\n".join(lines) + "</table>"


def _line(cell: str, row: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{cell}>{escape(text)}</{cell}>" for text in row) + "</tr>"


def picture(caption: str, pixels: Array) -> str:
    """A figure of uint8 pixels (H, W) or (H, W, 3), kept in the page itself."""
    from visint.io import encode_png

    data = b64encode(encode_png(np.ascontiguousarray(pixels))).decode("ascii")
    text = escape(caption)
    return (
        f'<figure><img alt="{text}" src="data:image/png;base64,{data}"><figcaption>{text}</figcaption></figure>'
    )


def shown_depth(depth: Array, truth: Array) -> Array:
    """uint8 (H, W): near is light, scaled to the range of the truth, black where there is none."""
    near, far = float(np.nanmin(truth)), float(np.nanmax(truth))
    light = 1 - (depth.astype(np.float64) - near) / max(far - near, 1e-9)
    seen = np.isfinite(truth) & np.isfinite(light)
    return np.where(seen, np.clip(np.nan_to_num(light), 0, 1) * 215 + 40, 0).astype(np.uint8)


def shown_normals(normals: Array, truth: Array) -> Array:
    """uint8 (H, W, 3): x, y, −z as red, green, blue; black outside the truth."""
    seen = np.isfinite(truth).all(axis=-1, keepdims=True) & np.isfinite(normals).all(axis=-1, keepdims=True)
    colors = (np.nan_to_num(normals) * np.array([1, 1, -1]) + 1) * 127.5
    return np.where(seen, colors, 0).astype(np.uint8)


def listed(notes: Sequence[str]) -> str:
    """Notes as a list."""
    return "<ul>" + "".join(f"<li>{escape(note)}</li>" for note in notes) + "</ul>"


def gallery(pictures: Mapping[str, Array]) -> str:
    """Pictures in a row."""
    return "<div>" + "".join(picture(caption, pixels) for caption, pixels in pictures.items()) + "</div>"
