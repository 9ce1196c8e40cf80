"""A drawing as a page of its own: one file, works offline, no script."""

from __future__ import annotations

from html import escape

from visint.graph.drawing.lettering import clean
from visint.graph.drawing.model import Drawing
from visint.graph.drawing.svg import svg

__all__ = ["page"]

_STYLE = """
:root{color-scheme:light dark}
body{margin:0 auto;padding:2rem 1.5rem;max-width:fit-content;background:#fff;color:#1c2733;
font-family:"Helvetica Neue",Helvetica,Arial,"Liberation Sans",sans-serif;line-height:1.5}
h1{font-size:1.5rem;margin:0}
p{margin:.25rem 0 1rem;max-width:44rem;color:#5b6875}
figure{margin:1rem 0;overflow-x:auto}
figure svg{display:block;max-width:100%;height:auto}
figcaption{font-size:.85rem;color:#5b6875;margin-top:.75rem}
@media (prefers-color-scheme:dark){body{background:#12171c;color:#e6ebf0}p,figcaption{color:#a3b0bc}}
"""
_POLICY = "default-src 'none'; style-src 'unsafe-inline'"
_KEY = "Data flows downwards. Framed: loops. Dashed: the value of the turn before."
_HUB_KEY = " Spokes read the map and write it, in the order of their numbers."


def page(drawing: Drawing) -> str:
    """``drawing`` as an HTML page."""
    title = escape(clean(drawing.name))
    about = f"<p>{escape(clean(drawing.about))}</p>\n" if drawing.about else ""
    hub = any(box.role == "map" for box in drawing.root.every())
    key = _KEY + (_HUB_KEY if hub else "")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        f"<title>{title}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n<main>\n"
        f"<h1>{title}</h1>\n{about}<figure>\n{svg(drawing)}<figcaption>{key}</figcaption>\n</figure>\n"
        "</main>\n</body>\n</html>\n"
    )
