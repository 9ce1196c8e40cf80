"""Building a graph in code: the same object that a graph file gives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from visint.errors import UsageError
from visint.graph.bind import bind
from visint.graph.complaints import made
from visint.graph.graph import INPUTS, Graph
from visint.graph.spec import GraphSpec, HubSpec, LoopSpec, NodeSpec
from visint.names import PortRef
from visint.registry import Catalog, installed

__all__ = ["Builder", "NodeHandle"]

Value = PortRef | str | tuple[PortRef | str, ...] | list[PortRef | str]


class NodeHandle:
    """A node that was added: its outputs are its attributes, ``match.disparity``."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, port: str) -> PortRef:
        if port.startswith("__"):
            raise AttributeError(port)
        return PortRef(self._name, port)

    def __repr__(self) -> str:
        return f"<node {self._name}>"


class Builder:
    """Assembles a graph node by node.

    Parameters
    ----------
    name
        The graph's name.
    catalog
        Where modules are looked up; everything installed if not given.
    inputs
        Name → kind, as in a graph file: ``left="Image", light="Light?", images=["Image"]``.

    Examples
    --------
    >>> import visint
    >>> g = visint.Builder("mine", left="Image", right="Image")
    >>> match = g.add("match", "stereo.sgm", left=g.left, right=g.right)
    >>> graph = g.outputs(disparity=match.disparity)
    >>> graph.name
    'mine'
    """

    def __init__(self, name: str, catalog: Catalog | None = None, **inputs: str | list[str]) -> None:
        self._name = name
        self._catalog = catalog
        self._inputs = {key: tuple(kind) if isinstance(kind, list) else kind for key, kind in inputs.items()}
        self._loops: dict[str, LoopSpec] = {}
        self._nodes: dict[str, NodeSpec] = {}
        self._hub: HubSpec | None = None
        self._controls: dict[str, dict[str, Any]] = {}
        self._about = ""

    def __getattr__(self, name: str) -> PortRef:
        if name.startswith("_") or name not in self._inputs:
            raise AttributeError(f"the graph has no input {name!r}; inputs: {', '.join(self._inputs)}")
        return PortRef(INPUTS, name)

    def about(self, text: str) -> Builder:
        """Says in a sentence what the graph is for."""
        self._about = text
        return self

    def loop(self, name: str, **spec: Any) -> str:
        """Adds a loop (``times=20``, or ``over="pyramid", coarsest=8``); returns its name for ``add``."""
        self._loops[name] = made(LoopSpec, spec, self._name, "loops", name)
        return name

    def add(
        self,
        node_name: str,
        uses: str,
        *,
        params: Mapping[str, Any] | None = None,
        feedback: Mapping[str, Mapping[str, Any]] | None = None,
        options: Mapping[str, Any] | None = None,
        **ports: Value,
    ) -> NodeHandle:
        """Adds a node.

        Parameters
        ----------
        node_name
            Its name in the graph.
        uses
            The module's id, ``graph:NAME`` for a sub-graph.
        params
            The module's parameters.
        feedback
            Port → ``{"from": ref, "start": ...}``.
        options
            The other keys of a node: ``loop``, ``levels``, ``at``, ``of``.
        ports
            Where each port comes from.

        Raises
        ------
        UsageError
            If the name is taken.
        """
        if node_name in self._nodes:
            raise UsageError.of("VI223", f"the graph has a node {node_name!r} already")
        fed = {port: {key: _text(one) for key, one in spec.items()} for port, spec in (feedback or {}).items()}
        ins = {port: _refs(value) for port, value in ports.items()}
        keys = {"uses": uses, "with": dict(params or {}), "in": ins, "feedback": fed, **(options or {})}
        self._nodes[node_name] = made(NodeSpec, keys, self._name, "nodes", node_name)
        return NodeHandle(node_name)

    def hub(self, spec: Mapping[str, Any]) -> NodeHandle:
        """Sets the hub, as the mapping a graph file would hold; gives the map, ``map.depth`` and so on."""
        self._hub = made(HubSpec, dict(spec), self._name, "hub")
        return NodeHandle("map")

    def control(self, name: str, **settings: Any) -> Builder:
        """Names a control: ``control("shading", **{"couple.alpha": 0})``."""
        self._controls[name] = settings
        return self

    def outputs(self, **outputs: PortRef | str) -> Graph:
        """The finished graph, bound and checked.

        Raises
        ------
        GraphError
            If it is wrong, as for a graph file.
        """
        parts = {
            "visint": 1,
            "name": self._name,
            "about": self._about,
            "inputs": self._inputs,
            "loops": self._loops,
            "nodes": self._nodes,
            "hub": self._hub,
            "controls": self._controls,
            "outputs": {name: str(ref) for name, ref in outputs.items()},
        }
        spec = made(GraphSpec, parts, self._name)
        return bind(spec, self._catalog or installed())


def _text(value: Any) -> Any:
    return str(value) if isinstance(value, PortRef) else value


def _refs(value: Value) -> str | tuple[str, ...]:
    if isinstance(value, str):
        return value
    return str(value) if isinstance(value, PortRef) else tuple(str(one) for one in value)
