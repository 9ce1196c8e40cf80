"""The bound graph: every name looked up, every port joined, every rule checked; free of run state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

from visint.fields.kinds import FieldKind
from visint.graph.spec import GraphSpec, InputSpec, LoopSpec, UntilSpec
from visint.module import Params, PortSpec
from visint.names import PortRef
from visint.registry import Catalog
from visint.registry.load import AnyModule

__all__ = ["INPUTS", "MAP", "Callee", "Edge", "Feedback", "Graph", "Loop", "Node", "Reader", "Until"]

INPUTS = "inputs"
"""The node that stands for the graph's inputs in references."""
MAP = "map"
"""The node that stands for the intrinsic map in references; the last commit of a hub bears the name."""

Reader = Literal["plain", "value", "luminance"]
"""How an edge reads its source: as it is, the value of evidence, or the luminance of a colour image."""


@dataclass(frozen=True, slots=True)
class Callee:
    """What a node runs, seen from outside: ports by name.

    ``module`` is a vision module's class, ``graph`` a sub-graph; where both are None it is the engine's own
    ``map.begin`` or ``map.commit``.
    """

    id: str
    inputs: Mapping[str, PortSpec]
    outputs: Mapping[str, PortSpec]
    module: type[AnyModule] | None = None
    graph: Graph | None = None
    origin: str = ""

    @property
    def version(self) -> str:
        """The module's version, empty for what has none."""
        return self.module.version if self.module else ""


class Edge(NamedTuple):
    """Where the value of a port comes from and how it is read; ``kind`` is the kind that arrives."""

    source: PortRef
    reader: Reader
    kind: FieldKind


@dataclass(frozen=True, slots=True)
class Feedback:
    """A port fed by the turn before of ``loop``, the innermost loop that holds both ends.

    ``start`` is None, a number, ``"plane"`` or an edge from outside the loop; at every turn of ``restart``
    the value starts anew.
    """

    edge: Edge
    loop: str
    start: float | str | Edge | None = None
    restart: str | None = None


@dataclass(frozen=True, slots=True)
class Node:
    """A node of the bound graph. ``ins`` holds one edge a port, or several for a list port."""

    name: str
    callee: Callee
    params: Params | Mapping[str, Any]
    at: Mapping[int, Params] = field(default_factory=dict)
    ins: Mapping[str, Edge | tuple[Edge, ...]] = field(default_factory=dict)
    feedback: Mapping[str, Feedback] = field(default_factory=dict)
    loop: str | None = None
    levels: tuple[int, ...] | None = None
    of: str | None = None

    def edges(self) -> Iterator[tuple[str, Edge]]:
        """(port, edge) of every in-edge, list ports spread out; feedback apart."""
        for port, edge in self.ins.items():
            if isinstance(edge, Edge):
                yield port, edge
            else:
                yield from ((port, one) for one in edge)


class Until(NamedTuple):
    """The end condition of a loop, its references resolved."""

    spec: UntilSpec
    change_of: Edge | None
    holds: Edge | None


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop of the bound graph."""

    name: str
    spec: LoopSpec
    until: Until | None = None

    @property
    def pyramid(self) -> bool:
        """Whether it runs over levels of resolution rather than a number of turns."""
        return self.spec.over == "pyramid"


@dataclass(frozen=True, slots=True)
class Graph:
    """A graph that can run, made by :func:`visint.load` or :class:`visint.Builder`; equal by its spec.

    Attributes
    ----------
    spec
        The file as data, the hub and all.
    plain_spec
        The same with the hub spelled out as nodes; the spec itself where there is no hub.
    inputs, loops, nodes, outputs
        What the spec's names stand for.
    file
        Where it was read from; empty for a graph built in code.
    """

    spec: GraphSpec
    plain_spec: GraphSpec = field(compare=False)
    inputs: Mapping[str, InputSpec] = field(compare=False)
    loops: Mapping[str, Loop] = field(compare=False)
    nodes: Mapping[str, Node] = field(compare=False)
    outputs: Mapping[str, Edge] = field(compare=False)
    catalog: Catalog = field(compare=False, repr=False)
    file: Path | None = field(default=None, compare=False)

    @property
    def name(self) -> str:
        """The graph's name."""
        return self.spec.name

    def __hash__(self) -> int:
        return hash(self.spec.name)

    def loops_around(self, loop: str | None) -> tuple[str, ...]:
        """The loops from the outermost to ``loop`` itself; none for None."""
        chain: list[str] = []
        while loop is not None:
            chain.append(loop)
            loop = self.loops[loop].spec.inside
        return tuple(reversed(chain))

    def pyramid_around(self, loop: str | None) -> str | None:
        """The pyramid that ``loop`` is or lies in, if any."""
        return next((name for name in self.loops_around(loop) if self.loops[name].pyramid), None)

    def _repr_html_(self) -> str:
        """The graph drawn, for notebooks."""
        from visint.graph.drawing import to_svg

        return to_svg(self.spec)

    def to_yaml(self) -> str:
        """The graph as the text of a graph file; reading it gives an equal graph."""
        from visint.graph.write import to_yaml

        return to_yaml(self.spec)

    def expanded(self) -> str:
        """The plain graph a hub graph stands for, as the text of a graph file with the same results."""
        from visint.graph.write import to_yaml

        return to_yaml(self.plain_spec)
