"""A laid-out graph as one ``<svg>``: no script, no outside reference, every text escaped."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from visint.graph.drawing.boxes import NAME, PORT, TEXT
from visint.graph.drawing.caption import HEAD, LINE, LONGEST
from visint.graph.drawing.geometry import Frame, Leg, Placed, Point, Rect
from visint.graph.drawing.layout import Layout, lay_out
from visint.graph.drawing.lettering import clean, fitted
from visint.graph.drawing.model import Drawing, Edge
from visint.graph.drawing.strokes import arrowhead, number, path
from visint.graph.drawing.style import STYLE

__all__ = ["svg"]


def svg(drawing: Drawing) -> str:
    """``drawing`` as an ``<svg>`` element, which carries its own style for light and dark."""
    layout = lay_out(drawing)
    size = f"{number(layout.w)} {number(layout.h)}".split()
    label = _quoted(f"graph {drawing.name}")
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="visint-graph" role="group" aria-label="{label}" '
        f'viewBox="0 0 {size[0]} {size[1]}" width="{size[0]}" height="{size[1]}">'
    )
    return "\n".join([head, f"<style>{STYLE}</style>", *_parts(drawing, layout), "</svg>\n"])


def _parts(drawing: Drawing, layout: Layout) -> Iterator[str]:
    yield from (_frame(frame, depth) for depth, frame in enumerate(layout.frames))
    yield from (_spoke(key, start, end) for key, start, end in layout.spokes)
    yield from (_edge(edge, legs) for edge, legs in layout.ways)
    yield from (_box(one, one.box.key == drawing.failed) for one in layout.placed)


def _frame(frame: Frame, depth: int) -> str:
    lines = [clean(frame.group.name), *frame.group.caption]
    rect = _rect(frame.rect, 12, "frame")
    x, y = frame.caption, frame.rect.y
    name = _text(Point(x, y + 20), f"↻ {fitted(frame.group.name)}", "loop", HEAD, "start")
    rest = [
        _text(Point(x, y + 36 + 14 * index), fitted(line, LONGEST), "bound", LINE, "start")
        for index, line in enumerate(frame.group.caption)
    ]
    inside = "".join([_title("loop " + "\n".join(lines)), rect, name, *rest])
    return _focusable(f"loop{depth % 2}", "loop " + ", ".join(lines), inside)


def _focusable(kind: str, label: str, inside: str) -> str:
    return f'<g class="{kind}" role="img" tabindex="0" aria-label="{_quoted(label)}">{inside}</g>'


def _spoke(key: str, start: Point, end: Point) -> str:
    name = clean(key.removeprefix("spoke "))
    heads = arrowhead(start, end) + arrowhead(end, start)
    line = f'<path class="line" d="M{number(start.x)},{number(start.y)}L{number(end.x)},{number(end.y)}"/>'
    tip = _title(f"{name} reads the map and writes it")
    return f'<g class="spoke">{tip}{line}<path class="head" d="{heads}"/></g>'


def _edge(edge: Edge, legs: tuple[Leg, ...]) -> str:
    end = legs[-1].points[-1]
    kind = "edge feedback" if edge.feedback else "edge"
    line = f'<path class="line" d="{path(legs)}"/>'
    head = f'<path class="head" d="{arrowhead(Point(end.x, end.y - 9), end)}"/>'
    return f'<g class="{kind}">{_title(_told(edge))}{line}{head}</g>'


def _told(edge: Edge) -> str:
    source, target = (key.partition(" ")[2] or key for key in (edge.source, edge.target))
    ends = [f"{name}.{port}" if port else name for name, port in ((source, edge.out), (target, edge.into))]
    return " → ".join(ends) + (" (the turn before)" if edge.feedback else "")


def _box(one: Placed, failed: bool) -> str:
    box, rect = one.box, one.rect
    tip = box.tip + ("\nfailed" if failed else "")
    label = f"{box.role} {box.name}: {box.text}" + (" (failed)" if failed else "")
    radius = {"map": rect.h / 2, "input": rect.h / 2, "output": rect.h / 2}.get(box.role, 9)
    kind = f"box {box.role}" + " failed" * failed
    inside = "".join([_title(tip), _rect(rect, radius, "body"), *_words(one)])
    return _focusable(kind, label, inside)


def _words(one: Placed) -> Iterator[str]:
    box, rect = one.box, one.rect
    middle = rect.middle
    if box.role == "map":
        inner = Rect(rect.x + 4, rect.y + 4, rect.w - 8, rect.h - 8)
        yield _rect(inner, inner.h / 2, "rim")
    yield _text(Point(middle.x, middle.y - 2), fitted(box.name), "name", NAME)
    yield _text(Point(middle.x, middle.y + 13), fitted(box.text), "text", TEXT)
    yield from _ports(one)
    if box.turn:
        x = rect.x + 3 if one.badge == "left" else rect.right - 3
        yield f'<circle class="turn" cx="{number(x)}" cy="{number(rect.y + 3)}" r="9"/>'
        yield _text(Point(x, rect.y + 6.5), str(box.turn), "count", TEXT)


def _ports(one: Placed) -> Iterator[str]:
    inset = 9 if one.box.role == "map" else 0
    for port, x in one.ins:
        yield _text(Point(x, one.rect.y + 12 + inset), fitted(port, 28), "port", PORT)
    for port, x in one.outs:
        yield _text(Point(x, one.rect.bottom - 6 - inset), fitted(port, 28), "port", PORT)


def _rect(rect: Rect, radius: float, kind: str) -> str:
    x, y, w, h = map(number, rect)
    return f'<rect class="{kind}" x="{x}" y="{y}" width="{w}" height="{h}" rx="{number(radius)}"/>'


def _text(at: Point, words: str, kind: str, size: float, anchor: str = "middle") -> str:
    if not words:
        return ""
    place = f'x="{number(at.x)}" y="{number(at.y)}" font-size="{number(size)}" text-anchor="{anchor}"'
    return f'<text class="{kind}" {place}>{_escaped(words)}</text>'


def _title(text: str) -> str:
    return "<title>" + "\n".join(_escaped(clean(line)) for line in text.splitlines()) + "</title>"


def _escaped(text: str) -> str:
    return escape(clean(text), quote=False)


def _quoted(text: str) -> str:
    return escape(clean(text), quote=True)
