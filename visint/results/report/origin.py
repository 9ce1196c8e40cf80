"""The sections on where the result comes from: the graph as text, modules, parameters, libraries."""

from __future__ import annotations

import json
from typing import Any

from visint.graph.drawing import to_svg
from visint.graph.spec import GraphSpec
from visint.results.provenance import libraries, modules, parameters
from visint.results.report.markup import Markup, element, joined, scrolling, table
from visint.results.report.setting import Setting

__all__ = ["graph", "versions"]


def graph(setting: Setting) -> Markup:
    """The graph drawn, and as the text of a graph file; a hub also as the plain nodes it stands for."""
    bound = setting.result.graph
    parts = [_drawn(bound.spec), _text("The graph file", bound.to_yaml())]
    if bound.spec.hub is not None:
        parts.append(_text("The plain graph that the hub stands for", bound.expanded()))
    return joined(parts)


def _drawn(spec: GraphSpec) -> Markup:
    drawn = Markup(to_svg(spec))  # escaped already, and tested there against hostile names
    says = "Data flows downwards. Framed: loops. Dashed: the value of the turn before."
    figure = element("figure", drawn, element("figcaption", says))
    return element("div", figure, class_="drawn", tabindex="0", role="region", aria_label="The graph, drawn")


def _text(title: str, text: str) -> Markup:
    shown = scrolling(title, element("pre", element("code", text)))
    return element("details", element("summary", title), shown)


def versions(setting: Setting) -> Markup:
    """Parameters of every node, versions of every module and library."""
    bound = setting.result.graph
    params = parameters(bound)
    nodes = [(name, node.callee.id, _params(params[name])) for name, node in bound.nodes.items()]
    brought = [(name, told["version"], told["from"]) for name, told in modules(bound).items()]
    return joined(
        [
            table("Parameters by node", ("node", "module", "parameters"), nodes),
            table("Modules", ("module", "version", "from"), brought) if brought else None,
            table("Libraries", ("library", "version"), list(libraries().items())),
        ]
    )


def _params(params: dict[str, Any]) -> Markup | str:
    if not params:
        return "none"
    each = [
        element("li", element("code", f"{name}: {json.dumps(value, ensure_ascii=False, default=str)}"))
        for name, value in params.items()
    ]
    return element("ul", *each, class_="plain")
