"""Float maps and numpy arrays as a field: the spec's dtype exactly, its shape, its range, unknown NaN."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from visint.arrays import Array, ArraySpec
from visint.io.files import Note
from visint.io.refusals import unfit

__all__ = ["conform", "typed"]

_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "Image": (0, 1),
        "Color": (0, 1),
        "Confidence": (0, 1),
        "Incidence": (0, 1),
        "BoundaryKinds": (0, 5),
        "Sigma": (0, math.inf),
    }
)
_WORDS = {"f": "floating-point", "i": "whole", "u": "whole", "b": "boolean"}


def typed(array: Array, spec: ArraySpec, name: str, note: Note) -> Array:
    """A new C-contiguous array of the spec's dtype; infinite is NaN, and the kind's range is held.

    float64 is rounded to float32 and ``note`` told so; a wider integer is taken if every value fits. Between
    truth values, whole and floating-point numbers nothing is converted: their scale would be a guess.

    Raises
    ------
    InputError
        VI305 if the array is of another sort of number, or out of range.
    """
    target = np.dtype(spec.dtype)
    if array.dtype.kind.replace("u", "i") != target.kind.replace("u", "i"):
        wanted = f"{_WORDS.get(target.kind, '')} numbers ({target})"
        write = f"array.astype({spec.dtype!r})"
        raise unfit(name, f"holds {array.dtype}; a {spec.kind} wants {wanted}", write=write)
    with np.errstate(over="ignore"):
        value = np.array(array, dtype=target, order="C")
    if target.kind == "f":
        _check_rounding(array, value, spec, name, note)
        value[np.isinf(value)] = np.nan
    elif target.kind in "iu" and not np.array_equal(value, array):
        raise unfit(name, f"holds whole numbers beyond {target}; a {spec.kind} wants {target}")
    _check_range(value, spec, name)
    return value


def _check_rounding(array: Array, value: Array, spec: ArraySpec, name: str, note: Note) -> None:
    if array.dtype.itemsize <= value.dtype.itemsize:
        return
    if (np.isinf(value) & np.isfinite(array)).any():
        raise unfit(name, f"holds values beyond {value.dtype}; a {spec.kind} wants {spec.dtype}")
    note(f"{name}: its {array.dtype} values are rounded to {value.dtype}")


def _check_range(value: Array, spec: ArraySpec, name: str) -> None:
    low, high = _RANGES.get(spec.kind, (-math.inf, math.inf))
    outside = (value < low) | (value > high) if math.isfinite(low) else np.zeros(1, dtype=bool)
    if outside.any():
        wanted = f"{low:g} to {high:g}" if math.isfinite(high) else f"values of at least {low:g}"
        found = f"has {int(outside.sum())} values out of range; a {spec.kind} wants {wanted}"
        raise unfit(name, found, write="array / array.max()" if high == 1 else "")


def conform(value: Array, spec: ArraySpec, name: str, note: Note) -> Array:
    """``value`` read-only, if its shape is the spec's and its vectors, if it holds normals, are normals.

    Raises
    ------
    InputError
        VI305, with what was found and wanted.
    """
    if not value.size:
        raise unfit(name, f"is empty: its shape is {value.shape}; wants {spec}")
    try:
        value = spec.check(value)
    except ValueError as error:
        raise unfit(name, str(error)) from None
    return spec.check(_normals(value, name, note)) if spec.kind == "Normals" else value


def _normals(value: Array, name: str, note: Note) -> Array:
    length = np.linalg.norm(value, axis=-1)
    empty = length == 0
    if empty.any():
        note(f"{name}: {int(empty.sum())} normals are zero and count as unknown")
        value = np.where(empty[..., None], np.float32(np.nan), value)
    if (np.abs(length[~empty & ~np.isnan(length)] - 1) > 1e-3).any():
        raise unfit(name, "has vectors that are not of length 1; wants unit normals, NaN where unknown")
    if (value[..., 2] > 0).sum() * 2 > (~np.isnan(value[..., 2])).sum():
        found = "has normals that face away; wants x right, y down, z forward, so z below 0 towards the camera"
        raise unfit(name, found, write="normals * (1, -1, -1)")
    return value
