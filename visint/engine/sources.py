"""Inputs of a graph from files and texts, by the kind that the graph declares."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from visint import io
from visint.errors import InputError, UsageError
from visint.fields.camera import Camera
from visint.fields.light import Light
from visint.graph.graph import Graph
from visint.graph.spec import InputSpec
from visint.results.provenance import Source

__all__ = ["numbers", "read_sources"]


def read_sources(graph: Graph, sources: Mapping[str, Source]) -> dict[str, Any]:
    """The values of the inputs named in ``sources``; all problems together.

    An image is read as the graph wants it (a colour file as luminance for an ``Image``). A camera is read
    from a calibration file; its text, if any, is the search range ``a,b`` in pixels, and without a file
    gives an uncalibrated camera of the images' size. A light's text is ``x,y,z`` (distant) or ``at x,y,z``.

    Raises
    ------
    InputError
        VI301 to VI306.
    UsageError
        VI701 where a text is not what its kind wants.
    """
    values: dict[str, Any] = {}
    problems: list[InputError] = []
    later = []
    for name, source in sources.items():
        spec = graph.inputs.get(name)
        if spec is not None and spec.kind == "Camera":
            later.append((name, source))
            continue
        try:
            values[name] = _read(name, spec, source)
        except InputError as error:
            problems.append(error)
    for name, source in later:
        try:
            values[name] = _camera(source, values)
        except InputError as error:
            problems.append(error)
    if problems:
        raise InputError(problem for error in problems for problem in error.problems)
    return values


def _read(name: str, spec: InputSpec | None, source: Source) -> Any:
    if spec is None:
        return None  # which inputs there are is said when the run begins
    if spec.kind == "Light":
        return _light(source.text or " ".join(source.paths))
    if spec.kind in ("Scalar", "Flag", "Text"):
        return _scalar(name, spec.kind, source.text or " ".join(source.paths))
    read = [io.read(path, spec.kind, gamma=source.gamma) for path in source.paths]
    if spec.many:
        return tuple(read)
    if len(read) != 1:
        raise UsageError.of("VI701", f"the input {name!r} is one {spec.kind}; {len(read)} files are given")
    return read[0]


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


def _camera(source: Source, values: Mapping[str, Any]) -> Camera:
    span = numbers(source.text, 2, "a search range is a,b in pixels") if source.text else None
    if span is not None and span[0] >= span[1]:
        raise UsageError.of("VI701", f"a search range a,b wants a < b; this is {source.text}")
    if source.paths:
        camera = io.read_camera(source.paths[0])
        return camera if span is None else camera.model_copy(update={"disparity_range": span})
    sizes = [value.shape[:2] for value in values.values() if hasattr(value, "shape")]
    if not sizes:
        raise UsageError.of("VI701", "a search range without a calibration needs an image")
    rows, columns = sizes[0]
    return Camera.uncalibrated(columns, rows, (span[0], span[1]) if span else None)
