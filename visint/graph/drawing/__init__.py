"""A graph drawn from its file alone: as a page, as an ``<svg>``, in Graphviz's language. No plugin is imported.

Loops are nested boxes with their bounds, feedback is dashed, a hub is a hub: the map in the middle, each spoke
joined to it both ways. A graph need not be right to be drawn: a reference to nothing is drawn as missing.
"""

from __future__ import annotations

from pathlib import Path

from visint.graph.drawing.compose import compose
from visint.graph.spec import GraphSpec

__all__ = ["spec_of", "to_dot", "to_html", "to_svg"]


def spec_of(source: str) -> GraphSpec:
    """The graph that ``source`` means, the name of an installed graph or a path, read but not bound.

    Raises
    ------
    GraphError
        VI108 if no graph has the name, VI101 to VI107 if the file is wrong.
    """
    from visint.graph.load import find_named
    from visint.graph.read import read_graph
    from visint.names import is_name
    from visint.registry import installed

    path = find_named(source, installed()) if is_name(source) else Path(source)
    return read_graph(path).spec


def to_dot(spec: GraphSpec, failed: str = "") -> str:
    """``spec`` in Graphviz's language, the node ``failed`` red; raises ``UsageError`` if there is none."""
    from visint.graph.drawing.dot import dot

    return dot(compose(spec, failed))


def to_html(spec: GraphSpec, failed: str = "") -> str:
    """``spec`` as one page that works offline, in light and dark; raises as :func:`to_dot`."""
    from visint.graph.drawing.page import page

    return page(compose(spec, failed))


def to_svg(spec: GraphSpec, failed: str = "") -> str:
    """``spec`` as one ``<svg>`` element to stand in any page, with its own style; raises as :func:`to_dot`."""
    from visint.graph.drawing.svg import svg

    return svg(compose(spec, failed))
