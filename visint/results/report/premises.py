"""The section on assumptions: what each module rests on, and where it found that to hold."""

from __future__ import annotations

from visint.fields.assumptions import meaning
from visint.results.premises import WHOLE, Premise
from visint.results.report.markup import Markup, Part, element, table
from visint.results.report.numbers import count, percent
from visint.results.report.setting import Setting

__all__ = ["assumptions"]

_WORDS = {"untested": "not tested", "held": "held", "violated": "violated", "mixed": "held in part"}


def assumptions(setting: Setting) -> Markup | None:
    """One row a node and assumption: its meaning, and in how many regions and pixels it held."""
    rows = [
        _row(node, name, premise)
        for node, some in setting.result.assumptions.items()
        for name, premise in some.items()
    ]
    heads = ("node", "assumption", "which says", "found", "regions and pixels")
    return table("What the modules assume, and where they found it to hold", heads, rows) if rows else None


def _row(node: str, name: str, premise: Premise) -> tuple[Part, ...]:
    words = name.rpartition(".")[2].replace("_", " ")
    return (
        node,
        words,
        meaning(name),
        element("span", _WORDS[premise.state], class_=premise.state),
        _where(premise),
    )


def _where(premise: Premise) -> str:
    if premise.state == "untested":
        return "–"
    if WHOLE in premise.held or WHOLE in premise.violated:
        return "the whole image"
    held, regions = len(premise.held), len(premise.held) + len(premise.violated)
    return f"{held} of {count(regions, 'region')}, {percent(premise.share)} of their pixels"
