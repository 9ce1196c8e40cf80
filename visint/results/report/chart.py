"""A line chart on a logarithmic scale, as SVG inside the page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from visint.results.report.markup import Markup, element, joined
from visint.results.report.numbers import number

__all__ = ["HUES", "log_chart"]

HUES = 8
"""Lines are drawn in the classes ``hue0`` to ``hue7`` of the style sheet, then from the first again."""

_WIDTH, _HEIGHT = 640, 260
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 12, 12, 36
_MOST_LABELS = 6

Line = Sequence[tuple[int, float]]


class _Scale(NamedTuple):
    """Turns ``first`` to ``last`` across, powers of ten ``low`` to ``high`` upwards."""

    first: int
    last: int
    low: int
    high: int

    def x(self, turn: float) -> float:
        share = (turn - self.first) / max(self.last - self.first, 1)
        return round(_LEFT + share * (_WIDTH - _LEFT - _RIGHT), 1)

    def y(self, value: float) -> float:
        share = (math.log10(value) - self.low) / (self.high - self.low) if value > 0 else 0.0
        return round(_HEIGHT - _BOTTOM - share * (_HEIGHT - _TOP - _BOTTOM), 1)


def log_chart(lines: Mapping[str, Sequence[Line]], bound: float | None, says: str) -> Markup:
    """The lines (turn, value ≥ 0) of each name, in a colour a name; 0 lies on the floor.

    Parameters
    ----------
    lines
        Name → lines of (turn, value), values finite.
    bound
        Drawn as a dashed line, if there is one.
    says
        What the chart shows, for those who do not see it.
    """
    points = [point for each in lines.values() for line in each for point in line]
    scale = _scale([turn for turn, _ in points], [value for _, value in points] + [bound or 0.0])
    drawn = [_line(line, scale, hue % HUES) for hue, each in enumerate(lines.values()) for line in each if line]
    chart = element(
        "svg",
        joined(_grid(scale)),
        None if bound is None else _bound(bound, scale),
        *drawn,
        viewBox=f"0 0 {_WIDTH} {_HEIGHT}",
        role="img",
        aria_label=says,
        class_="chart",
    )
    return element("div", chart, _names(list(lines), bound))


def _scale(turns: Sequence[int], values: Sequence[float]) -> _Scale:
    logs = [math.log10(value) for value in values if value > 0] or [0.0]
    low, high = math.floor(min(logs)), math.ceil(max(logs))
    return _Scale(min(turns), max(turns), low, max(high, low + 1))


def _grid(scale: _Scale) -> Iterator[Markup]:
    for power in _spread(scale.low, scale.high):
        y = scale.y(10.0**power)
        yield element("line", x1=_LEFT, x2=_WIDTH - _RIGHT, y1=y, y2=y, class_="grid")
        label = f"{10.0**power:g}" if -3 <= power <= 4 else f"1e{power}"
        yield element("text", label, x=_LEFT - 8, y=y + 4, text_anchor="end")
    for turn in _spread(scale.first, scale.last):
        yield element("text", turn, x=scale.x(turn), y=_HEIGHT - _BOTTOM + 18, text_anchor="middle")
    middle = (_LEFT + _WIDTH - _RIGHT) / 2
    yield element("text", "turn", x=middle, y=_HEIGHT - 3, text_anchor="middle")


def _spread(low: int, high: int) -> range:
    """Whole numbers from ``low`` to ``high``, not more than there is room for."""
    return range(low, high + 1, max(1, math.ceil((high - low) / _MOST_LABELS)))


def _line(line: Line, scale: _Scale, hue: int) -> Markup:
    where = [(scale.x(turn), scale.y(value)) for turn, value in line]
    path = element("polyline", points=" ".join(f"{x},{y}" for x, y in where))
    dots = [element("circle", cx=x, cy=y, r=2.5) for x, y in where]
    return element("g", path, *dots, class_=f"hue{hue}")


def _bound(bound: float, scale: _Scale) -> Markup:
    y = scale.y(bound)
    return element("line", x1=_LEFT, x2=_WIDTH - _RIGHT, y1=y, y2=y, class_="bound")


def _names(names: Sequence[str], bound: float | None) -> Markup:
    swatches = [
        element("span", element("span", class_=f"swatch hue{i % HUES}"), " ", name)
        for i, name in enumerate(names)
    ]
    if bound is not None:
        swatches.append(element("span", element("span", class_="swatch bound"), f" ends below {number(bound)}"))
    return element("p", *swatches, class_="key")
