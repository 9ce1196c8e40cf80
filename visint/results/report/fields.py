"""The sections that show fields: inputs, outputs with their confidence, and the evidence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from pydantic import BaseModel

from visint.arrays import Array
from visint.fields.evidence import Evidence
from visint.results.pictures import reference
from visint.results.report.drawings import drawing
from visint.results.report.maps import is_map
from visint.results.report.markup import Markup, Part, element, joined, table
from visint.results.report.numbers import number
from visint.results.report.setting import Setting

__all__ = ["evidence", "inputs", "outputs"]


def inputs(setting: Setting) -> Markup | None:
    """What the run was given: images as pictures, everything else in a table."""
    shown_first = reference(setting.result)
    pictures: list[Markup] = []
    others: list[tuple[Part, ...]] = []
    for name, value, kind in _inputs(setting):
        if is_map(value):
            first = shown_first is not None and value is shown_first[1] and not pictures
            pictures.append((setting.view if first else setting.figure)(name, kind, value))
        else:
            others.append((name, kind, _told(value)))
    if not pictures and not others:
        return None
    shown = [_grid(pictures)] if pictures else []
    if others:
        shown.append(table("Inputs that are no images", ("input", "kind", "value"), others))
    return joined(shown)


def _inputs(setting: Setting) -> Iterator[tuple[str, Any, str]]:
    """(name, value, kind) of each input, lists spread out."""
    for name, spec in setting.result.graph.inputs.items():
        value = setting.result.inputs.get(name)
        if isinstance(value, tuple):
            yield from ((f"{name}[{i}]", one, spec.kind) for i, one in enumerate(value))
        else:
            yield name, value, spec.kind


def outputs(setting: Setting) -> Markup:
    """What the run gave: maps as pictures, their confidence beside them, everything else in a table."""
    maps, kinds = setting.maps(), setting.result.kinds
    figures = [setting.over_view(name, kinds[name], value) for name, value in maps.items()]
    figures += [drawing(name, data) for name, data in setting.drawings.items()]
    figures += [
        setting.figure(f"confidence of {_listed(names)}", "Confidence", value)
        for names, value in _confidences(setting.result.confidence)
    ]
    shown = [_grid(figures)] if figures else []
    others = [
        (name, kinds[name], _told(value)) for name, value in setting.result.outputs.items() if name not in maps
    ]
    if others:
        shown.append(table("Outputs that are no maps", ("output", "kind", "value"), others))
    return joined(shown)


def _confidences(confidence: Mapping[str, Array]) -> Iterator[tuple[list[str], Array]]:
    """Each array of confidence once, with the outputs that share it."""
    named: dict[int, list[str]] = {}
    for name, value in confidence.items():
        named.setdefault(id(value), []).append(name)
    for names in named.values():
        if is_map(confidence[names[0]]):
            yield names, confidence[names[0]]


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def evidence(setting: Setting) -> Markup | None:
    """What each spoke said last: value, sigma and reliability side by side."""
    small = setting.small()
    each = [joined(_said(small, name, one)) for name, one in setting.result.evidence.items()]
    return joined(each) if each else None


def _said(setting: Setting, name: str, said: Evidence) -> Iterator[Markup]:
    unit = "rad" if said.measures == "Normals" else setting.unit(said.measures)
    parts = (
        ("value", said.measures, said.value, None),
        ("sigma", "Sigma", said.sigma, unit),
        ("reliability", "Confidence", said.reliability, None),
    )
    yield element("h3", name, " ", element("small", f"on {said.measures.lower()}"))
    yield _grid(
        [setting.figure(part, kind, value, given) for part, kind, value, given in parts],
        "row",
    )


def _grid(figures: list[Markup], class_: str = "grid") -> Markup:
    return element("div", *figures, class_=class_)


def _told(value: Any) -> Part:
    """A value that is no map, in words."""
    if value is None:
        return "not given"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return number(float(value))
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, BaseModel):
        return element("span", _fields(value))
    return value if isinstance(value, str) else f"an object of class {type(value).__name__}"


def _array(value: Array) -> str:
    shape = " × ".join(map(str, value.shape))
    if value.ndim == 1 and 0 < value.size <= 16 and value.dtype.kind in "biuf":
        return ", ".join(number(float(one)) for one in value)
    return f"{value.dtype} array of {shape}"


def _fields(model: BaseModel) -> str:
    """``name value`` of each field of a model that is a number, a word or a few of them."""
    simple = {name: _simple(value) for name, value in model if value is not None}
    return ", ".join(f"{name.replace('_', ' ')} {text}" for name, text in simple.items() if text)


def _simple(value: Any) -> str:
    if isinstance(value, tuple):
        return "(" + ", ".join(_simple(one) for one in value) + ")"
    if isinstance(value, bool | str):
        return str(value)
    return number(float(value)) if isinstance(value, int | float) else ""
