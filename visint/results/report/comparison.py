"""The section that compares the run with another one: figures, difference maps, what was set otherwise."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Set
from typing import Any

from visint.arrays import Array
from visint.results.against import Against
from visint.results.provenance import parameters
from visint.results.report.differences import Difference, difference
from visint.results.report.embed import embedded
from visint.results.report.markup import Markup, Part, element, joined, table
from visint.results.report.numbers import seconds
from visint.results.report.setting import Setting

__all__ = ["comparison"]

Row = tuple[Part, ...]


def comparison(setting: Setting) -> Markup | None:
    """What differs from the other run, output by output."""
    other = setting.against
    if other is None:
        return None
    found = dict(_differences(setting, other))
    rows = [(name, figure, value) for name, one in found.items() for figure, value in one.figures.items()]
    figures = [_figure(setting.small(), name, one) for name, one in found.items() if one.picture is not None]
    parts = [
        element("p", f"“Here” is this run of {setting.result.graph.name}, “there” the one in {other.folder}."),
        table("How the outputs differ: here less there", ("output", "figure", "value"), rows) if rows else None,
        element("div", *figures, class_="row") if figures else None,
        table("How the runs differ", ("what", "here", "there"), [*_runs(setting, other)]),
    ]
    return joined(parts)


def _differences(setting: Setting, other: Against) -> Iterator[tuple[str, Difference]]:
    for name, value in setting.maps().items():
        kind = setting.result.kinds[name]
        if name not in other.maps:
            yield name, Difference({"difference": "there is no such output there"})
        elif (problem := _unlike(kind, value, *other.maps[name])) is not None:
            yield name, Difference({"difference": problem})
        else:
            yield name, difference(kind, value, other.maps[name][1], setting.unit(kind))
    for name in other.maps.keys() - setting.maps().keys():
        yield name, Difference({"difference": "there is no such output here"})


def _unlike(kind: str, here: Array, other_kind: str, there: Array) -> str | None:
    if kind != other_kind:
        return f"{kind} here, {other_kind} there"
    if here.shape != there.shape:
        sizes = (" × ".join(map(str, shape)) for shape in (here.shape, there.shape))
        return "{} here, {} there: not compared".format(*sizes)
    return None


def _figure(setting: Setting, name: str, one: Difference) -> Markup:
    assert one.picture is not None
    told = "; ".join(f"{figure} {value}" for figure, value in list(one.figures.items())[:2])
    picture = embedded(one.picture, f"Difference of {name}: {told}", setting.side)
    caption = element("figcaption", element("strong", f"{name}, here less there"), " ", element("span", told))
    return element("figure", picture, one.legend, caption)


def _runs(setting: Setting, other: Against) -> Iterator[Row]:
    result = setting.result
    yield "graph", result.graph.name, other.graph
    yield "time", seconds(result.seconds), "unknown" if other.seconds is None else seconds(other.seconds)
    mine = parameters(result.graph)
    both = mine.keys() & other.parameters.keys()
    alone = [", ".join(sorted(nodes - both)) for nodes in (mine.keys(), other.parameters.keys())]
    if any(alone):
        yield "nodes of one alone", alone[0] or "–", alone[1] or "–"
    here, there = _flat(mine, both), _flat(other.parameters, both)
    for name in sorted(here.keys() | there.keys()):
        if here.get(name) != there.get(name):
            yield element("code", name), here.get(name, "–"), there.get(name, "–")


def _flat(by_node: Mapping[str, Mapping[str, Any]], nodes: Set[str]) -> dict[str, str]:
    """``node.parameter`` → its value as JSON, of these nodes."""
    return {
        f"{node}.{name}": json.dumps(value, ensure_ascii=False, default=str)
        for node, told in by_node.items()
        if node in nodes
        for name, value in told.items()
    }
