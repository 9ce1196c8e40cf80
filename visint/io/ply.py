"""PLY: a cloud of points with normals and colours, binary little-endian."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.io.refusals import inexact

__all__ = ["encode_ply"]

_NAMES = {
    "points": ("x", "y", "z"),
    "normals": ("nx", "ny", "nz"),
    "colors": ("red", "green", "blue"),
}
_TYPES = {"float": "<f4", "uchar": "u1"}


def encode_ply(
    points: Array, *, normals: Array | None = None, colors: Array | None = None, unit: str = ""
) -> bytes:
    """A PLY file of the known points.

    Parameters
    ----------
    points
        float32 (N, 3) or (H, W, 3), camera frame: x right, y down, z forward. Points that are not finite
        are left out.
    normals
        float32 of the same shape; an unknown normal of a known point is written as zeros.
    colors
        uint8 of the same shape, RGB as shown on screens (see :func:`visint.io.srgb_from_linear`).
    unit
        The points' unit, kept as a comment.

    Raises
    ------
    OutputError
        VI603 if an array has another dtype or shape.
    """
    parts = {"points": points, "normals": normals, "colors": colors}
    given = {part: array for part, array in parts.items() if array is not None}
    for part, array in given.items():
        _check(part, array, points.shape)
    fields = [(name, "uchar" if part == "colors" else "float") for part in given for name in _NAMES[part]]
    known = np.isfinite(points.reshape(-1, 3)).all(axis=1)
    rows = np.empty(int(known.sum()), dtype=[(name, _TYPES[type_]) for name, type_ in fields])
    for part, array in given.items():
        flat = array.reshape(-1, 3)[known]
        clean = np.nan_to_num(flat, nan=0.0, posinf=0.0, neginf=0.0) if part == "normals" else flat
        for axis, name in enumerate(_NAMES[part]):
            rows[name] = clean[:, axis]
    return _header(len(rows), fields, unit) + rows.tobytes()


def _check(part: str, array: Array, shape: tuple[int, ...]) -> None:
    wanted = np.dtype(np.uint8 if part == "colors" else np.float32)
    if array.dtype != wanted or array.shape != shape or array.ndim < 2 or array.shape[-1] != 3:
        found = f"PLY {part} are {array.dtype} {array.shape}; wants {wanted} (N, 3) or (H, W, 3), all alike"
        raise inexact(found)


def _header(count: int, fields: list[tuple[str, str]], unit: str) -> bytes:
    lines = ["ply", "format binary_little_endian 1.0", "comment frame x right, y down, z forward"]
    if unit:
        lines.append(f"comment unit {' '.join(unit.split())}")
    lines.append(f"element vertex {count}")
    lines += [f"property {type_} {name}" for name, type_ in fields]
    return ("\n".join([*lines, "end_header"]) + "\n").encode("ascii", "replace")
