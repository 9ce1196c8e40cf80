"""Numbers as people read them, and markup that escapes."""

from __future__ import annotations

import math

import pytest

from visint.results.report.chart import log_chart
from visint.results.report.markup import Markup, element, joined, table
from visint.results.report.numbers import count, number, percent, ranges, seconds, with_unit


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (0.5, "0.5"),
        (-2.25, "−2.25"),
        (1234.5678, "1235"),
        (123456.7, "123457"),
        (0.0001, "0.0001"),
        (0.00001234, "1.234e-05"),
        (1.5e9, "1.5e+09"),
        (math.nan, "unknown"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
    ],
)
def test_numbers_have_four_digits(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0, "0 %"),
        (1, "100 %"),
        (0.5, "50 %"),
        (0.1234, "12.3 %"),
        (1e-6, "less than 0.1 %"),
        (1 - 1e-6, "more than 99.9 %"),
    ],
)
def test_only_all_is_called_all(share, text):
    assert percent(share) == text


def test_durations():
    assert [seconds(s) for s in (0, 0.0123, 1.5, 119, 150)] == [
        "0 ms",
        "12.3 ms",
        "1.50 s",
        "119.00 s",
        "2 min 30 s",
    ]


def test_counts_ranges_and_units():
    assert [count(1, "turn"), count(2, "turn"), count(0, "box", "boxes")] == ["1 turn", "2 turns", "0 boxes"]
    assert [ranges([3]), ranges([2, 0, 1])] == ["3", "0 to 2"]
    assert [with_unit("3", "mm"), with_unit("3", "1"), with_unit("3", "")] == ["3 mm", "3", "3"]


def test_text_is_escaped_and_markup_is_not():
    inner = element("b", "<&>")
    assert inner == "<b>&lt;&amp;&gt;</b>"
    assert element("p", inner, "'\"", None, 3) == "<p><b>&lt;&amp;&gt;</b>&#x27;&quot;3</p>"
    assert isinstance(joined(["<"]), Markup)
    assert joined(["<", inner]) == "&lt;<b>&lt;&amp;&gt;</b>"


def test_attributes_are_escaped_and_spelled():
    made = element("img", alt='"><script>', class_="a", aria_label="b", title=None)
    assert made == '<img alt="&quot;&gt;&lt;script&gt;" class="a" aria-label="b">'


def test_joining_markup_with_text_loses_the_mark():
    """What is put together by hand is a text again, and escaped: the safe side."""
    by_hand = element("b", "x") + "<i>"
    assert element("p", by_hand) == "<p>&lt;b&gt;x&lt;/b&gt;&lt;i&gt;</p>"


def test_tables_name_their_rows():
    made = table("What", ("name", "value"), [("a", 1), ("<", None)])
    assert '<th scope="row">&lt;</th><td></td>' in made
    assert "<caption>What</caption>" in made


@pytest.mark.parametrize("line", [[(1, 0.5)], [(1, 0.0)], [(1, 1e-300), (2, 1e300)], [(1, 1.0), (500, 1.0)]])
def test_charts_of_any_values_stay_inside(line):
    """A point, a zero, a huge span, many turns: labels do not pile up, and points lie in the picture."""
    drawn = log_chart({"only": [line]}, None, "says")
    assert drawn.count("<text") <= 20
    points = drawn.partition('points="')[2].partition('"')[0].split()
    for x, y in (map(float, point.split(",")) for point in points):
        assert 0 <= x <= 640
        assert 0 <= y <= 260
