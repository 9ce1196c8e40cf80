"""How two maps of one kind differ: as a picture, and in figures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields.evidence import known
from visint.results import pictures
from visint.results.report.legends import change_bar, color_bar, key
from visint.results.report.markup import Markup
from visint.results.report.numbers import number, percent, with_unit

__all__ = ["Difference", "difference"]


class Difference(NamedTuple):
    """A picture uint8 (H, W, 3) with its legend, and the figures by name; no picture where all is equal."""

    figures: dict[str, str]
    picture: Array | None = None
    legend: Markup | None = None


def difference(kind: str, here: Array, there: Array, unit: str) -> Difference:
    """``here`` less ``there``, two maps of ``kind`` and of one shape, where both are known."""
    if np.array_equal(here, there, equal_nan=here.dtype.kind == "f"):
        return Difference({"difference": "none: equal to the last bit"})
    if kind == "Normals":
        return _normals(here, there)
    if kind in ("Boundaries", "Mask"):
        return _masks(here, there)
    return _labels(here, there) if kind == "Regions" else _numbers(here, there, unit)


def _share(where: Array) -> str:
    return percent(float(np.count_nonzero(where)) / where.size)


def _one_sided(here: Array, there: Array) -> dict[str, str]:
    """How much only one of the two knows."""
    known_here, known_there = known(here), known(there)
    return {
        "known here alone": _share(known_here & ~known_there),
        "known there alone": _share(known_there & ~known_here),
    }


def _numbers(here: Array, there: Array, unit: str) -> Difference:
    change = here.astype(np.float64) - there
    seen = change[known(change)]
    only = _one_sided(here, there)
    if not seen.size:
        return Difference({"difference": "nothing is known in both", **only})
    size = np.abs(seen)
    figures = {
        "median of |difference|": with_unit(number(float(np.median(size))), unit),
        "mean difference": with_unit(number(float(seen.mean())), unit),
        "root mean square": with_unit(number(float(np.sqrt(np.mean(seen**2)))), unit),
        "95th percentile of |difference|": with_unit(number(float(np.percentile(size, 95))), unit),
        **only,
    }
    most = float(np.percentile(size, 98)) or float(size.max())
    if most == 0:
        return Difference(figures)
    return Difference(figures, pictures.of_change(change, most), change_bar(most, unit))


def _normals(here: Array, there: Array) -> Difference:
    cosine = np.clip(np.sum(here.astype(np.float64) * there, axis=-1), -1, 1)
    angle = np.degrees(np.arccos(cosine))
    seen = angle[known(angle)]
    only = _one_sided(here, there)
    if not seen.size:
        return Difference({"difference": "nothing is known in both", **only})
    most = max(float(np.percentile(seen, 98)), 1e-3)
    figures = {
        "median angle": f"{number(float(np.median(seen)))}°",
        "mean angle": f"{number(float(seen.mean()))}°",
    }
    picture = pictures.of_scalar(angle, 0.0, most)
    return Difference({**figures, **only}, picture, color_bar(0.0, most, "°"))


def _masks(here: Array, there: Array) -> Difference:
    table: dict[str, tuple[Array, tuple[int, int, int]]] = {
        "in both": (here & there, (255, 255, 255)),
        "here alone": (here & ~there, (178, 24, 43)),
        "there alone": (there & ~here, (33, 102, 172)),
    }
    picture = np.zeros((*here.shape, 3), np.uint8)
    for where, color in table.values():
        picture[where] = color
    legend = key({"white": "in both", "only-here": "here alone", "only-there": "there alone"})
    return Difference({name: _share(where) for name, (where, _) in table.items()}, picture, legend)


def _labels(here: Array, there: Array) -> Difference:
    """Labels have no order: what can be compared is where their boundaries lie, and how many there are."""
    counts = {"regions here": here, "regions there": there}
    figures = {name: str(np.unique(labels[labels > 0]).size) for name, labels in counts.items()}
    return Difference(figures)
