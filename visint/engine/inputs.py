"""What a caller gives, held against the inputs a graph declares."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from visint import io
from visint.arrays import ArraySpec
from visint.errors import InputError, Problem
from visint.fields.camera import Camera
from visint.graph.graph import INPUTS, Graph, Node
from visint.graph.spec import InputSpec
from visint.names import did_you_mean, listed

__all__ = ["accept", "accept_value", "camera_of", "misfits", "size_of"]


def accept(graph: Graph, given: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs of a run: every declared one there (or None where optional), of the declared kind.

    Raises
    ------
    InputError
        VI304 for a missing or unknown input, VI305 for a wrong kind, VI307 where inputs do not fit
        each other. All together.
    """
    problems = []
    for name in given:
        if name not in graph.inputs:
            near = did_you_mean(name, graph.inputs)
            choices = "inputs: " + listed(f"{n}: {s}" for n, s in graph.inputs.items())
            found = f"the graph {graph.name!r} has no input {name!r}"
            problems.append(InputError.of("VI304", found, choices=choices, write=f"{near}=" if near else ""))
    values = {}
    for name, spec in graph.inputs.items():
        try:
            values[name] = _accept_one(graph, name, spec, given.get(name))
        except InputError as error:
            problems.append(error)
    if problems:
        raise InputError(problem for error in problems for problem in error.problems)
    _fit_each_other(graph, values)
    return values


def _accept_one(graph: Graph, name: str, spec: InputSpec, value: Any) -> Any:
    if value is None:
        if spec.optional:
            return None
        raise InputError.of("VI304", f"the input {name!r} ({spec}) is missing", write=f"{name}=…")
    kind = graph.catalog.kind(spec.kind)
    array = kind.array if kind else None
    if spec.many:
        if not isinstance(value, list | tuple):
            raise InputError.of(
                "VI305", f"the input {name!r} is a list, {spec}; this is a {type(value).__name__}"
            )
        return tuple(accept_value(f"{name}[{i}]", spec.kind, array, one) for i, one in enumerate(value))
    return accept_value(name, spec.kind, array, value)


def accept_value(name: str, kind: str, array: ArraySpec | None, value: Any) -> Any:
    """One value of an input: read-only, of the kind; other floats become the declared one.

    Raises
    ------
    InputError
        VI305, with a hint for whole numbers.
    """
    if array is None:
        return _plain(name, kind, value)
    value = np.asarray(value) if isinstance(value, list | tuple) else value
    if isinstance(value, np.ndarray):
        value = _exact(value, array.dtype)
        if kind == "Image" and value.dtype == np.float32 and value.shape[2:] == (3,):
            value = io.luminance(value)
    try:
        return array.check(value)
    except ValueError as error:
        hint = _hint(value, array)
        raise InputError.of("VI305", f"the input {name!r}: {error}", write=hint) from None


def _exact(value: Any, dtype: str) -> Any:
    """Other floats become the declared one; integers do not, for nobody knows their scale."""
    both_float = value.dtype.kind == "f" and np.dtype(dtype).kind == "f"
    return value.astype(dtype, copy=False) if both_float else value


def _hint(value: Any, array: ArraySpec) -> str:
    if isinstance(value, np.ndarray) and value.dtype.kind in "ui" and array.dtype == "float32":
        top = np.iinfo(value.dtype).max
        return f"image.astype(np.float32) / {top}   (and undo the sRGB curve: visint.io.read does both)"
    return ""


def _plain(name: str, kind: str, value: Any) -> Any:
    value = value.item() if isinstance(value, np.generic) else value
    wanted = {"Scalar": (int, float), "Flag": (bool,), "Text": (str,)}.get(kind)
    if wanted is None:
        found = getattr(type(value), "__kind__", type(value).__qualname__)
        if found != kind and kind in ("Camera", "Light"):
            raise InputError.of(
                "VI305", f"the input {name!r} wants {kind}; this is {found}", write=f"visint.{kind}(…)"
            )
        return value
    if not isinstance(value, wanted) or (isinstance(value, bool) and kind == "Scalar"):
        raise InputError.of("VI305", f"the input {name!r} wants {kind}; this is {type(value).__name__}")
    return value


def size_of(graph: Graph, values: Mapping[str, Any]) -> tuple[int, int] | None:
    """(rows, columns) of the run: those of the first input that is a map of pixels."""
    for name, value in values.items():
        first = value[0] if isinstance(value, tuple) and value else value
        kind = graph.catalog.kind(graph.inputs[name].kind)
        if isinstance(first, np.ndarray) and kind and kind.array and kind.array.dims[:2] == ("H", "W"):
            return first.shape[0], first.shape[1]
    return None


def camera_of(values: Mapping[str, Any]) -> Camera | None:
    """The camera among the inputs, if there is one."""
    return next((value for value in values.values() if isinstance(value, Camera)), None)


def _fit_each_other(graph: Graph, values: Mapping[str, Any]) -> None:
    problems = misfits(graph, values)
    if problems:
        raise InputError(problems)
    camera, size = camera_of(values), size_of(graph, values)
    if size is not None and min(size) == 0:
        raise InputError.of("VI305", f"the images are empty: {size[0]} × {size[1]} pixels")
    if camera is not None and size is not None and camera.size != size:
        found = f"the camera is of {camera.width} × {camera.height} pixels, the images of {size[1]} × {size[0]}"
        raise InputError.of("VI307", found)


def misfits(graph: Graph, values: Mapping[str, Any]) -> list[Problem]:
    """Maps of pixels that meet in a node, and are not of one size."""
    found: dict[str, None] = {}
    several = len(set(_shapes(values))) > 1  # else there is no need to go through the nodes at every run
    for node in graph.nodes.values() if several else ():
        sizes = dict(_sizes(node, values))
        for name, size in sizes.items():
            first, wanted = next(iter(sizes.items()))
            if size != wanted:
                said = f"{wanted[1]} × {wanted[0]} and {size[1]} × {size[0]} pixels"
                found[f"the inputs {first!r} and {name!r} are of different sizes: {said}"] = None
    return [Problem("VI307", one, fault="input") for one in found]


def _shapes(values: Mapping[str, Any]) -> Iterator[tuple[int, ...]]:
    for value in values.values():
        for one in value if isinstance(value, tuple) else (value,):
            if isinstance(one, np.ndarray):
                yield one.shape[:2]


def _sizes(node: Node, values: Mapping[str, Any]) -> Iterator[tuple[str, tuple[int, int]]]:
    for port, edge in node.edges():
        spec = node.callee.inputs.get(port)
        array = spec.array if spec else None
        if edge.source.node != INPUTS or array is None or array.dims[:2] != ("H", "W"):
            continue
        name, value = edge.source.port, values.get(edge.source.port)
        if isinstance(value, tuple):
            yield from ((f"{name}[{i}]", one.shape[:2]) for i, one in enumerate(value))
        elif value is not None:
            yield name, value.shape[:2]
