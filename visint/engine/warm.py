"""A warm start: fields that the map is to begin with, held against what it stores."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from visint.engine.commit import stored_kinds
from visint.engine.inputs import accept_value
from visint.errors import InputError
from visint.fields.kinds import KINDS, FieldKind
from visint.graph.callees import BEGIN
from visint.graph.graph import Graph
from visint.names import did_you_mean, listed

__all__ = ["accept_start"]


def accept_start(graph: Graph, given: Mapping[str, Any], size: tuple[int, int] | None) -> dict[str, Any]:
    """The fields, and ``<field>_confidence``, to start from: read-only, of their kinds, of full ``size``.

    Raises
    ------
    InputError
        VI304 where the graph has no such field, VI305 for a wrong kind, VI307 for another size. All together.
    """
    if not given:
        return {}
    kinds = _kinds(graph)
    values: dict[str, Any] = {}
    problems: list[InputError] = []
    for name, value in given.items():
        try:
            values[name] = _accept_one(graph, kinds, name, value, size)
        except InputError as error:
            problems.append(error)
    if problems:
        raise InputError(problem for error in problems for problem in error.problems)
    return values


def _kinds(graph: Graph) -> dict[str, FieldKind]:
    kinds: dict[str, FieldKind] = {}
    for node in graph.nodes.values():
        if node.callee.id == BEGIN:
            stored = stored_kinds(node)
            kinds |= stored | {f"{name}_confidence": KINDS["Confidence"] for name in stored}
    return kinds


def _accept_one(
    graph: Graph, kinds: Mapping[str, FieldKind], name: str, value: Any, size: tuple[int, int] | None
) -> Any:
    if not kinds:
        raise InputError.of("VI304", f"the graph {graph.name!r} has no map that could start from {name!r}")
    if name not in kinds:
        found = f"the map of {graph.name!r} has no field {name!r}"
        near = did_you_mean(name, kinds)
        raise InputError.of("VI304", found, choices="fields: " + listed(kinds), write=near or "")
    value = accept_value(name, kinds[name].name, kinds[name].array, value)
    if isinstance(value, np.ndarray) and size is not None and value.shape[:2] != size:
        found = f"the start of {name!r} is of {value.shape[1]} × {value.shape[0]} pixels"
        raise InputError.of("VI307", f"{found}, the images of {size[1]} × {size[0]}")
    return value
