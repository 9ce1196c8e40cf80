"""Inputs of a graph from files and texts, by the kind that the graph declares."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from visint import io
from visint.engine.inputs import misfits
from visint.engine.rectified import calibrated
from visint.errors import InputError, Problem, UsageError
from visint.fields.camera import Camera
from visint.fields.light import Light
from visint.graph.graph import Graph
from visint.io.files import Note, silent
from visint.names import did_you_mean, listed
from visint.results.provenance import Source

__all__ = ["Say", "numbers", "read_sources"]

Say = Callable[[str, str], None]
"""Told the name of an input and one sentence: what reading it changed."""

_SHORT = {"left": "--left PATH", "right": "--right PATH", "camera": "--calib PATH", "light": "--light x,y,z"}


def read_sources(graph: Graph, sources: Mapping[str, Source], say: Say | None = None) -> dict[str, Any]:
    """The values of the inputs named in ``sources``; all problems together.

    An image is read as the graph wants it (a colour file as luminance for an ``Image``). A camera is read
    from a calibration file; its text, if any, is the search range ``a,b`` in pixels, and without a file
    gives an uncalibrated camera of the images' size. A light's text is ``x,y,z`` (distant) or ``at x,y,z``.

    Raises
    ------
    InputError
        VI301 to VI306; VI304 too for what is missing or not wanted, VI307 for images of different sizes
        that meet in a node.
    UsageError
        VI701 where a text is not what its kind wants.
    """
    values: dict[str, Any] = {}
    problems = [*_not_wanted(graph, sources), *_missing(graph, sources)]
    for name in sorted(sources, key=lambda name: _kind(graph, name) == "Camera"):  # it may want a size
        if name not in graph.inputs:
            continue
        try:
            values[name] = _read(graph, name, sources[name], values, say)
        except InputError as error:
            problems += error.problems
    problems += misfits(graph, values)
    if problems:
        raise InputError(problems)
    return values


def _kind(graph: Graph, name: str) -> str:
    return graph.inputs[name].kind if name in graph.inputs else ""


def _not_wanted(graph: Graph, sources: Mapping[str, Source]) -> Iterator[Problem]:
    for name in sources:
        if name not in graph.inputs:
            choices = "inputs: " + listed(f"{one}: {spec}" for one, spec in graph.inputs.items())
            near = None if name in _SHORT else did_you_mean(name, graph.inputs)
            found = f"the graph {graph.name!r} has no input {name!r}"
            yield Problem(
                "VI304", found, choices=choices, write=f"--in {near}=PATH" if near else "", fault="input"
            )


def _missing(graph: Graph, sources: Mapping[str, Source]) -> Iterator[Problem]:
    for name, spec in graph.inputs.items():
        if name not in sources and not spec.optional:
            write = _SHORT.get(name, f"--in {name}=PATH")
            yield Problem("VI304", f"the input {name!r} ({spec}) is missing", write=write, fault="input")


def _read(graph: Graph, name: str, source: Source, values: dict[str, Any], say: Say | None) -> Any:
    spec, note = graph.inputs[name], partial(say, name) if say else silent
    if spec.kind == "Camera":
        return _camera(graph, name, source, (values, note))
    if spec.kind == "Light":
        return _light(source.text)
    if spec.kind in ("Scalar", "Flag", "Text"):
        return _scalar(name, spec.kind, source.text)
    read = [io.read(path, spec.kind, gamma=source.gamma, note=note) for path in source.paths]
    return tuple(read) if spec.many else _one(name, spec.kind, read)


def _one(name: str, kind: str, given: Any) -> Any:
    if len(given) != 1:
        raise UsageError.of("VI701", f"the input {name!r} is one {kind}; {len(given)} files are given")
    return given[0]


def _light(text: str) -> Light:
    at = text.startswith("at ")
    x, y, z = numbers(text.removeprefix("at "), 3, "a light is x,y,z")
    try:
        return Light.at(x, y, z) if at else Light.distant(x, y, z)
    except ValueError as error:
        raise UsageError.of("VI701", str(error), write="--light 0,0,-1") from None


def _scalar(name: str, kind: str, text: str) -> Any:
    if kind == "Text":
        return text
    if kind == "Flag":
        if text not in ("true", "false"):
            raise UsageError.of("VI701", f"the input {name!r} is true or false; this is {text!r}")
        return text == "true"
    return numbers(text, 1, f"the input {name!r} is a number")[0]


def numbers(text: str, count: int, wanted: str) -> tuple[float, ...]:
    """``count`` numbers spelled ``a,b,c``.

    Raises
    ------
    UsageError
        VI701, saying what is ``wanted``.
    """
    try:
        found = tuple(float(word) for word in text.split(","))
    except ValueError:
        found = ()
    if len(found) != count or not all(abs(one) < float("inf") for one in found):
        raise UsageError.of("VI701", f"{wanted}; this is {text!r}")
    return found


def _camera(graph: Graph, name: str, source: Source, beside: tuple[dict[str, Any], Note]) -> Camera | None:
    values, note = beside
    span = numbers(source.text, 2, "a search range is a,b in pixels") if source.text else None
    if span is not None and span[0] >= span[1]:
        raise UsageError.of("VI701", f"a search range a,b wants a < b; this is {source.text}")
    if source.paths:
        camera = calibrated(graph, _one(name, "Camera", source.paths), values, note)
        return camera if span is None else camera.model_copy(update={"disparity_range": span})
    sizes = [value.shape[:2] for value in values.values() if hasattr(value, "shape")]
    if not sizes:  # what is wrong with the images is said beside this
        return None
    rows, columns = sizes[0]
    return Camera.uncalibrated(columns, rows, (span[0], span[1]) if span else None)
