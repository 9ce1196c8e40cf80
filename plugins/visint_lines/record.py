"""Line diagrams and labels as JSON."""

from __future__ import annotations

import json
from math import inf
from typing import Any

from visint_lines.catalogue import KINDS, LABELS
from visint_lines.diagram import Arc, Diagram, Measures
from visint_lines.labels import ArcLabel, Labels

__all__ = ["diagram_record", "fits_record", "labels_record"]

ABOUT = {
    "coordinates": "x (column) and y (row) in pixels of the image, pixel centres at integers",
    "labels": "walking from start to end: + convex, - concave, > occluding with its surface on the right, "
    "< on the left, >> and << limbs, x mark",
    "angles": "radians, counter-clockwise as seen, from the right",
}


def diagram_record(diagram: Diagram) -> bytes:
    """The diagram, without labels."""
    return _json(_told(diagram, None))


def labels_record(labels: Labels) -> bytes:
    """The diagram with every arc's label and every junction's type, their probabilities and their geometry."""
    return _json(_told(labels.diagram, labels))


def fits_record(fits: Any) -> bytes:
    """Superquadrics by region: half-axes, roundness, rotation vector, centre, rms distance."""
    told = [
        {
            "region": label,
            **{k: [_number(v) for v in vs] for k, vs in fit.shape._asdict().items()},
            "rms": fit.rms,
        }
        for label, fit in fits.of
    ]
    return _json({"superquadrics": told})


def _told(diagram: Diagram, labels: Labels | None) -> dict[str, Any]:
    told: dict[str, Any] = {"about": ABOUT, "rows": diagram.size[0], "columns": diagram.size[1]}
    if labels is not None:
        told |= {"method": labels.method, "exact": labels.exact}
    own = labels.arcs if labels is not None else (None,) * len(diagram.arcs)
    told["junctions"] = [_junction(diagram, number, labels) for number in range(len(diagram.junctions))]
    told["arcs"] = [_arc(arc, label) for arc, label in zip(diagram.arcs, own, strict=True)]
    return told


def _junction(diagram: Diagram, number: int, labels: Labels | None) -> dict[str, Any]:
    junction = diagram.junctions[number]
    told: dict[str, Any] = {"x": _number(junction.x), "y": _number(junction.y)}
    told["arcs"] = [
        {"arc": s.arc, "end": "start" if s.outward else "end", "angle": _number(s.angle)}
        for s in junction.spokes
    ]
    if junction.frame:
        told["frame"] = True
    if labels is not None:
        own = labels.junctions[number]
        shares = {kind: _number(share) for kind, share in own.probabilities.items()}
        told |= {"type": own.type, "legal": own.legal, "probabilities": shares}
    return told


def _arc(arc: Arc, label: ArcLabel | None) -> dict[str, Any]:
    told: dict[str, Any] = {"start": arc.start, "end": arc.end} if not arc.closed else {"closed": True}
    told |= {"left": arc.left, "right": arc.right}
    if label is not None:
        shares = {name: _number(p) for name, p in zip(LABELS, label.probabilities, strict=True)}
        told |= {"label": label.label, "kind": KINDS[label.label], "probabilities": shares}
    if arc.measures is not None:
        told["features"] = _features(arc.measures)
    told["points"] = [[_number(x), _number(y)] for x, y in _thinned(arc)]
    return told


def _features(measures: Measures) -> dict[str, Any]:
    return {name: None if abs(v) == inf else _number(v) for name, v in measures._asdict().items()}


def _thinned(arc: Arc) -> list[tuple[float, float]]:
    """Every other point, and the last."""
    kept = [*arc.points[:-1:2].tolist(), arc.points[-1].tolist()]
    return [(x, y) for x, y in kept]


def _number(value: float) -> float:
    """Rounded to what is worth writing."""
    return round(float(value), 4)


def _json(told: dict[str, Any]) -> bytes:
    lines = json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False)
    return (_flat(lines) + "\n").encode()


def _flat(text: str) -> str:
    """Pairs of numbers on one line."""
    import re

    return re.sub(r"\[\s+(-?[\d.e-]+),\s+(-?[\d.e-]+)\s+\]", r"[\1, \2]", text)
