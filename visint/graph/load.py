"""From a name or a path to a bound graph."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from visint.errors import GraphError, Problem
from visint.graph.bind import bind
from visint.graph.graph import Graph
from visint.graph.read import parse_data, read_graph
from visint.names import did_you_mean, is_name, listed
from visint.registry import Catalog, installed

__all__ = ["find_named", "load", "load_named", "parse_graph"]


def load(source: str | PathLike[str] | Graph, catalog: Catalog | None = None) -> Graph:
    """The graph that ``source`` means, bound and checked.

    Parameters
    ----------
    source
        The name of an installed graph (``"joint"``), the path of a graph file, or a graph, given back as it is.
    catalog
        Where modules and graphs are looked up; everything installed if not given.

    Raises
    ------
    GraphError
        If there is no such graph, or it is wrong: all problems of a phase together, with their places.
    PluginError
        If a plugin that the graph uses is broken.
    """
    if isinstance(source, Graph):
        return source
    catalog = catalog or installed()
    if isinstance(source, str) and is_name(source):
        return load_named(source, catalog)
    return _load_file(Path(source), catalog)


def load_named(name: str, catalog: Catalog, calling: tuple[str, ...] = ()) -> Graph:
    """The installed graph ``name``; ``calling`` are the graphs being bound around it."""
    if name in catalog.recorded:
        source = parse_data(catalog.recorded[name], f"graph:{name}")
        return bind(source.spec, catalog, source.places, None, (*calling, name))
    return _load_file(find_named(name, catalog), catalog, (*calling, name))


def find_named(name: str, catalog: Catalog) -> Path:
    """The file of the installed graph ``name``; :class:`GraphError` VI108 if there is none."""
    path = catalog.graph_file(name)
    if path is None:
        known = catalog.graphs()
        near = did_you_mean(name, known)
        write = near or f"./{name}.yaml  (a path, for a file of your own)"
        raise GraphError(
            Problem("VI108", f"no graph is named {name!r}", choices="graphs: " + listed(known), write=write)
        )
    return path


def _load_file(path: Path, catalog: Catalog, calling: tuple[str, ...] = ()) -> Graph:
    source = read_graph(path)
    return bind(source.spec, catalog, source.places, path, calling)


def parse_graph(text: str, catalog: Catalog | None = None, file: str = "graph") -> Graph:
    """The bound graph in ``text``, the whole of a graph file; ``file`` is what messages call it."""
    from visint.graph.read import parse

    source = parse(text, file)
    return bind(source.spec, catalog or installed(), source.places)
