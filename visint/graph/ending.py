"""A graph that ends at one of its nodes: what the node gives is among its outputs."""

from __future__ import annotations

from visint.graph.bind import bind
from visint.graph.callees import BEGIN, COMMIT
from visint.graph.graph import Graph
from visint.graph.read import Places

__all__ = ["ending_at"]


def ending_at(graph: Graph, node: str) -> Graph:
    """``graph`` with each port of ``node`` among its outputs, as ``NODE_PORT``; itself if it has them all.

    A node that there is not, or one of the map's own, changes nothing.
    """
    found = graph.nodes.get(node)
    if found is None or found.callee.id in (BEGIN, COMMIT):
        return graph
    given = set(graph.spec.outputs.values())
    more = {
        f"{node}_{port}"[:64]: f"{node}.{port}"
        for port in found.callee.outputs
        if f"{node}.{port}" not in given
    }
    if not more:
        return graph
    spec = graph.spec.model_copy(update={"outputs": {**graph.spec.outputs, **more}})
    return bind(spec, graph.catalog, Places(str(graph.file or spec.name)), graph.file)
