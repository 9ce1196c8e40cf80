"""Labels drawn in the field's notation: + and − beside creases, arrows along what occludes, two along limbs."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator

import numpy as np

from visint.arrays import Array
from visint_lines.catalogue import FLIP, KINDS
from visint_lines.diagram import Arc
from visint_lines.labels import ArcLabel, JunctionLabel, Labels

__all__ = ["svg"]

COLORS = {
    "limb": "#e64b35",
    "occluding": "#f5c33c",
    "convex": "#4dbbd5",
    "concave": "#a090ff",
    "mark": "#b8b8b8",
}
LEAST = 14.0
"""Pixels of an arc below which it gets no symbol."""
FADED = 0.6
"""Probability below which a line is dashed."""


def svg(labels: Labels) -> bytes:
    """A picture of the labels over the image, a unit a pixel; surfaces lie to the right of arrows."""
    height, width = labels.diagram.size
    unit = max(height, width) / 256
    body = [*_ground(labels), '<g fill="none" stroke-linecap="round">']
    pairs = list(zip(labels.diagram.arcs, labels.arcs, strict=True))
    body += [line for arc, label in pairs for line in _line(arc, label, unit)]
    body.append("</g>")
    body += [sign for arc, label in pairs for sign in _sign(arc, label, unit)]
    for junction, told in zip(labels.diagram.junctions, labels.junctions, strict=True):
        body += _junction(junction.x, junction.y, told, unit)
    start = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-0.5 -0.5 {width} {height}" '
        f'width="{max(width, 512)}" role="img">'
    )
    counts = _counts(labels)
    return "\n".join([start, f"<title>Line labels: {counts}</title>", *body, "</svg>\n"]).encode()


def _counts(labels: Labels) -> str:
    kinds = [KINDS[arc.label] for arc in labels.arcs]
    told = [f"{kinds.count(kind)} {kind}" for kind in COLORS if kind in kinds]
    return ", ".join(told) or "no lines"


def _ground(labels: Labels) -> Iterator[str]:
    from visint.io import encode_png

    height, width = labels.diagram.size
    box = f'x="-0.5" y="-0.5" width="{width}" height="{height}"'
    yield f'<rect {box} fill="#202020"/>'
    if labels.picture is not None:
        data = b64encode(encode_png(labels.picture)).decode()
        yield f'<image {box} opacity="0.55" href="data:image/png;base64,{data}"/>'


def _line(arc: Arc, label: ArcLabel, unit: float) -> Iterator[str]:
    spots = " ".join(f"{x:.2f},{y:.2f}" for x, y in arc.points)
    dash = f' stroke-dasharray="{3 * unit:.1f} {3 * unit:.1f}"' if label.probability < FADED else ""
    color = COLORS[KINDS[label.label]]
    says = f"{KINDS[label.label]}, probability {label.probability:.2f}"
    look = f'stroke="{color}" stroke-width="{1.4 * unit:.2f}"{dash}'
    yield f'<polyline points="{spots}" {look}><title>{says}</title></polyline>'


def _sign(arc: Arc, label: ArcLabel, unit: float) -> Iterator[str]:
    if arc.length < LEAST * unit:
        return
    color = COLORS[KINDS[label.label]]
    if label.label == "x":
        return
    if label.label in "+-":
        spot, across = _middle(arc.points)
        x, y = spot + 5 * unit * across
        text = "+" if label.label == "+" else "−"
        yield _text(x, y, text, color, 9 * unit)
        return
    forward = label.label in (">", ">>")  # surface on the right as one walks
    points = arc.points if forward else arc.points[::-1]
    for share in (0.5,) if len(FLIP[label.label]) == 1 else (0.44, 0.56):
        yield _arrow(points, share, color, unit)


def _middle(points: Array) -> tuple[Array, Array]:
    """(the point half-way, the unit vector to its right)."""
    at = len(points) // 2
    along = points[min(at + 2, len(points) - 1)] - points[max(at - 2, 0)]
    along = along / max(float(np.hypot(*along)), 1e-9)
    return points[at], np.array([-along[1], along[0]])


def _arrow(points: Array, share: float, color: str, unit: float) -> str:
    """A filled head that points along the curve."""
    at = min(max(int(share * len(points)), 1), len(points) - 1)
    back = points[max(0, at - 3)]
    along = points[at] - back
    along = along / max(float(np.hypot(*along)), 1e-9)
    across = np.array([-along[1], along[0]])
    tip, tail = points[at] + 3.5 * unit * along, points[at] - 3 * unit * along
    corners = (tip, tail + 3 * unit * across, tail - 3 * unit * across)
    spots = " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)
    return f'<polygon points="{spots}" fill="{color}"/>'


def _junction(x: float, y: float, told: JunctionLabel, unit: float) -> Iterator[str]:
    if told.type in ("frame", "-"):
        return
    color = "#ffffff" if told.legal else "#ff60c0"
    says = ", ".join(f"{kind} {share:.2f}" for kind, share in told.probabilities.items())
    place = f'cx="{x:.2f}" cy="{y:.2f}" r="{1.6 * unit:.2f}"'
    yield f'<circle {place} fill="{color}"><title>{told.type}: {says}</title></circle>'
    yield _text(x + 4 * unit, y - 3 * unit, "A" if told.type == "W" else told.type, color, 7 * unit)


def _text(x: float, y: float, text: str, color: str, size: float) -> str:
    return (
        f'<text x="{x:.2f}" y="{y:.2f}" fill="{color}" font-size="{size:.1f}" font-family="sans-serif" '
        f'text-anchor="middle" dominant-baseline="central">{text}</text>'
    )
