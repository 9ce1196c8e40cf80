"""Sample inputs of any module, made from what its ports declare: equal seeds give equal samples."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple

import numpy as np

from visint.arrays import Array, ArraySpec
from visint.fields import Camera, Evidence, Light
from visint.module import Ports, PortSpec

__all__ = ["CAN_BE_UNKNOWN", "Content", "Size", "sample_array", "sample_camera", "sample_inputs"]

Size = tuple[int, int]
Content = Literal["noise", "grey", "holes", "unknown"]
"""``noise``; ``grey``, no texture at all; ``holes``, noise a third of which is unknown; all ``unknown``."""

CAN_BE_UNKNOWN = frozenset({"Depth", "Disparity", "Relief", "Normals", "Slopes", "Incidence", "Sigma"})
"""The built-in kinds in which NaN stands for unknown; an image or a confidence is known everywhere."""

_RANGES: Mapping[str, tuple[float, float]] = {
    "Depth": (400.0, 800.0),
    "Disparity": (2.0, 12.0),
    "Relief": (-1.0, 1.0),
    "Slopes": (-0.5, 0.5),
    "Sigma": (0.1, 2.0),
}


def sample_inputs(
    ports: type[Ports], size: Size, content: Content = "noise", seed: int = 0, *, listed: int = 3
) -> Any:
    """Inputs (or outputs) of a module with every port filled.

    Parameters
    ----------
    ports
        ``SomeModule.Inputs``.
    size
        (rows, columns): lengths of the dims H and W. Any other named dim has the length ``listed``.
    content
        What arrays hold; labels and flags are noise in every case but ``grey``.
    seed
        Of the noise. A port's noise depends on its name too.
    listed
        How many values a list holds.

    Raises
    ------
    TypeError
        For a port of a class that is not visint's own.
    """
    made = _Maker(size, content, seed, listed)
    return ports(**{name: made.port(spec) for name, spec in ports.specs.items()})


class _Maker(NamedTuple):
    """What all samples of one call have in common."""

    size: Size
    content: Content
    seed: int
    listed: int

    def port(self, spec: PortSpec) -> Any:
        key = (self.seed, zlib.crc32(spec.name.encode()))
        if spec.many:
            return tuple(self.one(spec, (*key, i)) for i in range(self.listed))
        return self.one(spec, key)

    def one(self, spec: PortSpec, key: tuple[int, ...]) -> Any:
        if spec.array is not None:
            value = sample_array(spec.array, self.size, self.content, np.random.default_rng(key), self.listed)
            return _evidence(spec.kind, value, np.random.default_rng((*key, 1))) if spec.evidence else value
        if spec.kind not in _PLAIN:
            raise TypeError(f"no sample of {spec.kind} for port {spec.name!r}; write make_inputs yourself")
        return _PLAIN[spec.kind](self.size)


def sample_array(
    spec: ArraySpec, size: Size, content: Content, rng: np.random.Generator, other: int = 3
) -> Array:
    """An array of ``spec``; dims that are neither H nor W nor fixed have the length ``other``."""
    lengths = {"H": size[0], "W": size[1]}
    shape = tuple(d if isinstance(d, int) else lengths.get(d, other) for d in spec.dims)
    dtype = np.dtype(spec.dtype)
    if dtype.kind == "b":
        return rng.random(shape) < (0.0 if content == "grey" else 0.2)
    if spec.kind == "BoundaryKinds":
        return rng.integers(0, 1 if content == "grey" else 6, shape, dtype=dtype)
    if dtype.kind in "iu":
        return rng.integers(1, 2 if content == "grey" else 4, shape, dtype=dtype)
    low, high = _RANGES.get(spec.kind, (0.0, 1.0))
    value = np.full(shape, (low + high) / 2) if content == "grey" else rng.uniform(low, high, shape)
    if spec.kind == "Normals":
        value = _facing(value)
    if spec.kind in CAN_BE_UNKNOWN and content in ("holes", "unknown"):
        value[rng.random(shape[:2]) < (1.0 if content == "unknown" else 1 / 3)] = np.nan
    return value.astype(dtype)


def _facing(value: Array) -> Array:
    """Unit vectors within 45° of (0, 0, −1) from numbers in [0, 1]."""
    vectors = np.stack([value[..., 0] - 0.5, value[..., 1] - 0.5, np.full(value.shape[:-1], -1.0)], axis=-1)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _evidence(kind: str, value: Array, rng: np.random.Generator) -> Evidence:
    shape = value.shape[:2]
    trust = rng.uniform(0.1, 1.0, shape).astype(np.float32)
    return evidence_class(kind).of(value, rng.uniform(0.1, 1.0, shape).astype(np.float32), trust)


def evidence_class(kind: str) -> type[Evidence]:
    """The class of evidence that measures ``kind``, strangers' included.

    Raises
    ------
    TypeError
        If there is none.
    """
    found = list(Evidence.__subclasses__())
    for each in found:
        if each.measures == kind:
            return each
        found.extend(each.__subclasses__())
    raise TypeError(f"no subclass of Evidence measures {kind!r}")


def sample_camera(size: Size) -> Camera:
    """A camera of ``size``: 53° of view, baseline 100, disparities 0 to 16, as many again by convergence."""
    rows, columns = size
    return Camera(
        focal_length=max(rows, columns),
        cx=(columns - 1) / 2,
        cy=(rows - 1) / 2,
        baseline=100.0,
        width=columns,
        height=rows,
        doffs=4.0,
        disparity_range=(0.0, 16.0),
    )


_PLAIN: Mapping[str, Callable[[Size], Any]] = {
    "Camera": sample_camera,
    "Light": lambda _: Light.distant(0.3, -0.2, -1.0),
    "Scalar": lambda _: 0.75,
    "Flag": lambda _: True,
    "Text": lambda _: "sample",
}
