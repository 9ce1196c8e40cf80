"""The page: its sections in order, in the template, small enough to be sent by mail."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from hashlib import sha256
from string import Template
from typing import TYPE_CHECKING, NamedTuple

from visint import io
from visint.results.provenance import installed_version
from visint.results.report import attribution, comparison, course, fields, origin, premises, surface
from visint.results.report.drawings import drawings
from visint.results.report.legends import gradients
from visint.results.report.markup import Markup, element, joined
from visint.results.report.numbers import count, seconds
from visint.results.report.setting import Setting

if TYPE_CHECKING:
    from visint.results.against import Against
    from visint.results.result import Result

__all__ = ["MOST_BYTES", "SECTIONS", "report"]

MOST_BYTES = 3_000_000
"""How large a report may be; pictures are reduced until it fits."""

_SIDE, _SMALLEST = 1280, 64
"""The longest side of a picture: what is wanted, and what will do."""


class Section(NamedTuple):
    """One section: its name in addresses, its heading, and what makes its content (None leaves it out)."""

    name: str
    title: str
    content: Callable[[Setting], Markup | None]


SECTIONS = (
    Section("warnings", "Warnings", course.warnings),
    Section("comparison", "Compared with another run", comparison.comparison),
    Section("inputs", "Inputs", fields.inputs),
    Section("surface", "Surface", surface.surface),
    Section("outputs", "Outputs", fields.outputs),
    Section("evidence", "Evidence", fields.evidence),
    Section("attribution", "Who decided", attribution.attribution),
    Section("assumptions", "Assumptions", premises.assumptions),
    Section("convergence", "Convergence", course.convergence),
    Section("timings", "Timings", course.timings),
    Section("measures", "Measures", course.measures),
    Section("graph", "Graph", origin.graph),
    Section("versions", "Parameters and versions", origin.versions),
)
"""The sections in the order of the page."""


def report(result: Result, against: Against | None = None) -> str:
    """The whole report of ``result`` as the text of an HTML file, compared with another run if one is given.

    Nothing in it asks the network for anything. One script runs, the page's own: its policy names it by its
    SHA-256 and forbids every other, and without it the page shows all but the sliders and the surface. Apart
    from the timings the same run gives the same text. Pictures of more than 1280 pixels a side are reduced,
    and further until the whole is at most :data:`MOST_BYTES` long; the files beside the report have every
    pixel.
    """
    side = _SIDE
    setting = Setting(result, side, against, drawings(result))
    text = _page(setting)
    while (size := len(text.encode())) > MOST_BYTES and side > _SMALLEST:
        side = max(_SMALLEST, int(0.95 * side * (MOST_BYTES / size) ** 0.5))  # bytes go with the area
        text = _page(setting._replace(side=side))
    return text


def _page(setting: Setting) -> str:
    made = [(section, section.content(setting)) for section in SECTIONS]
    filled = [(section, content) for section, content in made if content]
    result = setting.result
    script = io.resource_text(__package__, "report.js")
    return Template(io.resource_text(__package__, "report.html")).substitute(
        style=io.resource_text(__package__, "report.css"),
        title=joined([result.graph.name]),
        about=element("p", result.graph.spec.about, class_="about") if result.graph.spec.about else "",
        facts=_facts(result),
        gradients=gradients(),
        contents=joined(
            element("li", element("a", section.title, href=f"#{section.name}")) for section, _ in filled
        ),
        sections=joined(_section(section, content) for section, content in filled),
        script=script,
        digest=b64encode(sha256(script.encode()).digest()).decode(),
        version=joined([installed_version("visint")]),
    )


def _section(section: Section, content: Markup) -> Markup:
    heading = element("h2", section.title, id=f"{section.name}-title")
    return element("section", heading, content, id=section.name, aria_labelledby=f"{section.name}-title")


def _facts(result: Result) -> Markup:
    calls = sum(timing.calls for timing in result.record.timings())
    facts = {
        "time": seconds(result.seconds),
        "nodes": f"{len(result.graph.nodes)}, called {count(calls, 'time')}",
        "outputs": ", ".join(result.outputs),
        "warnings": str(len(result.warnings)) if result.warnings else "none",
        "seed": str(result.seed),
    }
    return element(
        "dl", *(element("div", element("dt", name), element("dd", told)) for name, told in facts.items())
    )
