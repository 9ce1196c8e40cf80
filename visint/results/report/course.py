"""The sections on how the run went: why loops ended, what nodes cost, what modules said."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence

from visint.results.records import Stop, Timing, Turn, Warned
from visint.results.report.chart import Line, log_chart
from visint.results.report.markup import Markup, element, joined, table
from visint.results.report.numbers import count, number, ranges, seconds
from visint.results.report.setting import Setting

__all__ = ["convergence", "measures", "timings", "warnings"]


def convergence(setting: Setting) -> Markup | None:
    """Why each loop ended, level by level, and how much its watched value changed from turn to turn."""
    stops = setting.result.stops
    if not stops:
        return None
    rows = [
        (loop, level, count(len(some), "time"), ranges([stop.turns for stop in some]), _why(setting, some[0]))
        for (loop, level, _), some in _grouped(stops).items()
    ]
    heads = ("loop", "level", "ran", "turns", "and ended because")
    return joined([table("Why each loop ended", heads, rows), *_charts(setting)])


def _grouped(stops: Sequence[Stop]) -> dict[tuple[str, int, str], list[Stop]]:
    groups: dict[tuple[str, int, str], list[Stop]] = defaultdict(list)
    for stop in stops:
        groups[stop.loop, stop.level, stop.reason].append(stop)
    return groups


def _why(setting: Setting, stop: Stop) -> str:
    loop = setting.result.graph.loops.get(stop.loop)
    if loop and loop.pyramid:
        return "every level was done"
    until = loop.until.spec if loop and loop.until else None
    watched = until.change_of if until and until.change_of else "what it watches"
    bound = number(until.below) if until and until.below else "its bound"
    held = until.holds if until and until.holds else "its condition"
    return {
        "times": "it went round as often as it was told to",
        "converged": f"{watched} changed by less than {bound}",
        "held": f"{held} became true",
        "exhausted": "its bound on turns came before its end condition: it did not converge",
    }[stop.reason]


def _charts(setting: Setting) -> Iterator[Markup]:
    by_loop: dict[str, list[Turn]] = defaultdict(list)
    for turn in setting.result.trace:
        if math.isfinite(turn.change) and turn.change >= 0:
            by_loop[turn.loop].append(turn)
    for name, turns in by_loop.items():
        loop = setting.result.graph.loops.get(name)
        until = loop.until.spec if loop and loop.until else None
        watched = until.change_of if until and until.change_of else "the watched value"
        title = f"Relative change of {watched} per turn of {name}"
        chart = log_chart(_by_level(turns), until.below if until else None, _says(title, turns))
        yield element("figure", chart, element("figcaption", title), class_="plain")


def _by_level(turns: Sequence[Turn]) -> dict[str, list[Line]]:
    """Lines by level, the coarsest first as they ran; turns from 1, and a loop that ran again a new line."""
    lines: dict[str, list[list[tuple[int, float]]]] = defaultdict(list)
    for turn in turns:
        of_level = lines[f"level {turn.level}"]
        if not of_level or of_level[-1][-1][0] > turn.turn:
            of_level.append([])
        of_level[-1].append((turn.turn + 1, turn.change))
    return {name: list(each) for name, each in lines.items()}


def _says(title: str, turns: Sequence[Turn]) -> str:
    first, last = turns[0], turns[-1]
    return (
        f"{title}, on a logarithmic scale: from {number(first.change)} at level {first.level} "
        f"to {number(last.change)} at level {last.level}, {count(len(turns), 'turn')}"
    )


def timings(setting: Setting) -> Markup | None:
    """Calls and seconds of each node, with a bar each."""
    nodes = _by_node(setting)
    if not nodes:
        return None
    most = max(sum(one.seconds for one in some) for some in nodes.values()) or 1.0
    total = setting.result.seconds
    rows = [_timing_row(setting, name, some, most) for name, some in nodes.items()]
    spent = sum(one.seconds for some in nodes.values() for one in some)
    share = f"The run took {seconds(total)}; its nodes took {seconds(spent)} of work."
    heads = ("node", "module", "level", "calls", "time", "share")
    return joined([element("p", share), table("Time by node", heads, rows)])


def _by_node(setting: Setting) -> dict[str, list[Timing]]:
    """Timings by node in the graph's order, whatever ran first; those of sub-graphs behind."""
    nodes: dict[str, list[Timing]] = {name: [] for name in setting.result.graph.nodes}
    for timing in setting.result.record.timings():
        nodes.setdefault(timing.node, []).append(timing)
    return {name: some for name, some in nodes.items() if some}


def _timing_row(
    setting: Setting, name: str, some: Sequence[Timing], most: float
) -> tuple[str | int | Markup, ...]:
    node = setting.result.graph.nodes.get(name)
    spent = sum(one.seconds for one in some)
    bar = element("rect", width=round(100 * spent / most, 2), height=8)
    drawn = element("svg", bar, viewBox="0 0 100 8", preserveAspectRatio="none", aria_hidden="true")
    return (
        name,
        node.callee.id if node else "in a sub-graph",
        ranges([one.level for one in some]),
        sum(one.calls for one in some),
        seconds(spent),
        element("span", drawn, class_="share"),
    )


def warnings(setting: Setting) -> Markup | None:
    """What modules and the engine had to say, each thing once."""
    said: dict[tuple[str, str, str], list[Warned]] = defaultdict(list)
    for warned in setting.result.warnings:
        said[warned.node, warned.code, warned.text].append(warned)
    if not said:
        return None
    return element("ul", *(_warning(*key, some) for key, some in said.items()))


def _warning(node: str, code: str, text: str, some: Sequence[Warned]) -> Markup:
    often = count(len(some), "time")
    place = f"level {ranges([warned.level for warned in some])}, {often}"
    return element("li", element("strong", node), f": {text} ", element("small", f"({code}, {place})"))


def measures(setting: Setting) -> Markup | None:
    """Numbers that modules recorded: how often, and the first and the last."""
    found: dict[tuple[str, str, int], list[float]] = defaultdict(list)
    for measure in setting.result.record.measures:
        found[measure.node, measure.name, measure.level].append(measure.value)
    rows = [
        (node, name, level, len(values), number(values[0]), number(values[-1]))
        for (node, name, level), values in found.items()
    ]
    heads = ("node", "measure", "level", "times", "first", "last")
    return table("Numbers that modules recorded", heads, rows) if rows else None
