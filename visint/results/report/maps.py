"""Maps as figures: the picture, its legend, its range and how much of it is known."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields.boundary_kind import BoundaryKind
from visint.fields.evidence import known
from visint.results import pictures
from visint.results.report.embed import embedded
from visint.results.report.legends import color_bar, grey_bar, key, normals_key
from visint.results.report.markup import Markup, element
from visint.results.report.numbers import count, number, percent, with_unit

__all__ = ["Map", "figure", "is_map", "over", "picture"]

_LINE = (255, 106, 26)
"""The colour of boundaries over a photograph: seldom one of its own, and told from both black and white."""


class Map(NamedTuple):
    """A map to be shown: its title, field kind, array and unit."""

    title: str
    kind: str
    value: Array
    unit: str = "1"


class _View(NamedTuple):
    picture: Array
    legend: Markup | None
    facts: str


def is_map(value: Any) -> bool:
    """Whether ``value`` is an array with a pixel to show: (H, W) or (H, W, C) of numbers or booleans."""
    return (
        isinstance(value, np.ndarray) and value.ndim in (2, 3) and value.size > 0 and value.dtype.kind in "biuf"
    )


def figure(shown: Map, side: int, name: str | None = None) -> Markup:
    """The figure of a map, its picture at most ``side`` pixels long and called ``name``."""
    return _figure(shown, _view(shown), side, name)


def over(shown: Map, side: int) -> Markup:
    """The same to lie over the reference view: the script adds the view beneath, and a slider between them.

    Lines are drawn on nothing and the view fades; of any other map the slider shows one part.
    """
    view = _OVER.get(shown.kind, _view)(shown)
    return _figure(shown, view, side, data_over="fade" if shown.kind in _OVER else "swipe")


def picture(shown: Map) -> Array:
    """The picture of a map alone, uint8 (H, W, 3)."""
    return _view(shown).picture


def _view(shown: Map) -> _View:
    return _VIEWS.get(shown.kind, _by_type(shown.value))(shown)


def _figure(shown: Map, view: _View, side: int, name: str | None = None, **attributes: str) -> Markup:
    alt = f"{shown.kind} {shown.title}: {view.facts}"
    caption = element("figcaption", element("strong", shown.title), " ", element("span", view.facts))
    return element("figure", embedded(view.picture, alt, side, name), view.legend, caption, **attributes)


def _by_type(value: Array) -> Callable[[Map], _View]:
    """How an array of a kind that only a plugin knows is shown."""
    if value.dtype.kind == "b":
        return _mask
    return _regions if value.dtype.kind in "iu" and value.ndim == 2 else _scalar


def _scalar(shown: Map) -> _View:
    value = _lengths(shown.value)
    low, high = pictures.span(value)
    seen = known(value)
    facts = _range(value, shown.unit)
    varies = np.unique(value[seen]).size > 1
    legend = element(
        "div",
        color_bar(low, high, shown.unit) if varies else None,
        None if seen.all() else key({"unknown": "unknown"}),
    )
    facts = f"{facts}, {percent(_share(seen))} known" if seen.any() else facts
    return _View(pictures.of_scalar(value, low, high), legend, facts)


def _lengths(value: Array) -> Array:
    """A map of vectors by their length; one of numbers as it is."""
    if value.ndim == 2:
        return value
    return np.asarray(np.linalg.norm(value.astype(np.float64), axis=-1))


def _range(value: Array, unit: str) -> str:
    seen = value[known(value)]
    if not seen.size:
        return "nothing is known"
    low, high = float(seen.min()), float(seen.max())
    if low == high:
        return f"{with_unit(number(low), unit)} everywhere"
    return with_unit(f"{number(low)} to {number(high)}", unit)


def _share(where: Array) -> float:
    return float(np.count_nonzero(where)) / where.size


def _normals(shown: Map) -> _View:
    seen = known(shown.value)
    facts = f"{percent(_share(seen))} known"
    return _View(pictures.of_normals(shown.value), normals_key(not seen.all()), facts)


def _mask(shown: Map) -> _View:
    flat = shown.value if shown.value.ndim == 2 else np.logical_or.reduce(shown.value, axis=-1)
    legend = key({"white": "set", "black": "not set"})
    return _View(pictures.of_mask(flat), legend, f"{percent(_share(flat))} of the pixels")


def _boundaries(shown: Map) -> _View:
    return _mask(shown)._replace(legend=key({"white": "boundary"}))


def _boundary_kinds(shown: Map) -> _View:
    seen = [kind for kind in BoundaryKind if kind and (shown.value == kind).any()]
    counts = [f"{count(int(np.count_nonzero(shown.value == kind)), 'pixel')} {_NAMED[kind]}" for kind in seen]
    legend = key({kind.name.lower(): _NAMED[kind] for kind in seen}) if seen else None
    return _View(pictures.of_boundary_kinds(shown.value), legend, ", ".join(counts) or "no boundaries")


_NAMED = {
    BoundaryKind.LIMB: "limb",
    BoundaryKind.OCCLUDING: "occluding edge",
    BoundaryKind.CONVEX: "convex crease",
    BoundaryKind.CONCAVE: "concave crease",
    BoundaryKind.MARK: "mark",
}


def _lines(shown: Map) -> _View:
    view = _boundaries(shown)
    lines = view.picture & np.array(_LINE, np.uint8)
    return view._replace(picture=pictures.on_nothing(lines), legend=key({"line": "boundary"}))


def _lines_of_kinds(shown: Map) -> _View:
    view = _boundary_kinds(shown)
    return view._replace(picture=pictures.on_nothing(view.picture))


def _regions(shown: Map) -> _View:
    labels = np.unique(shown.value)
    facts = f"{count(int(np.count_nonzero(labels)), 'region')}, {percent(_share(shown.value != 0))} labelled"
    return _View(pictures.of_regions(shown.value), key({"black": "boundary"}), facts)


def _confidence(shown: Map) -> _View:
    facts, mean = _range(shown.value, "1"), float(np.nan_to_num(shown.value).mean(dtype=np.float64))
    if " to " in facts:
        facts += f", {number(mean)} on average"
    return _View(pictures.of_confidence(shown.value), grey_bar(), facts)


def _image(shown: Map) -> _View:
    height, width = shown.value.shape[:2]
    facts = f"{width} × {height} pixels, {_range(shown.value, '1')}"
    return _View(pictures.of_image(shown.value), None, facts)


_VIEWS: dict[str, Callable[[Map], _View]] = {
    "Image": _image,
    "Color": _image,
    "Normals": _normals,
    "Boundaries": _boundaries,
    "BoundaryKinds": _boundary_kinds,
    "Mask": _mask,
    "Regions": _regions,
    "Confidence": _confidence,
    "Incidence": _confidence,
}
_OVER: dict[str, Callable[[Map], _View]] = {"Boundaries": _lines, "BoundaryKinds": _lines_of_kinds}
