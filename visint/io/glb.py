"""GLB: a triangle mesh with normals and colours in one file (binary glTF 2.0, ISO/IEC 12113).

glTF looks along −z with y up, in metres: the points are stored as they are, in the camera's frame and unit,
and the one node of the scene turns and scales them.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from visint.arrays import Array
from visint.io.curves import linear_from_srgb
from visint.io.refusals import inexact

__all__ = ["encode_glb"]

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
_FLOAT, _SHORT, _INT = 5126, 5123, 5125
_VERTICES, _INDICES = 34962, 34963
_JSON, _BIN = b"JSON", b"BIN\0"


def encode_glb(
    points: Array, faces: Array, *, normals: Array | None = None, colors: Array | None = None, unit: str = ""
) -> bytes:
    """A GLB file of exactly these triangles.

    Parameters
    ----------
    points
        float32 (N, 3), camera frame: x right, y down, z forward; finite.
    faces
        int32 or uint32 (M, 3): the corners of each triangle, counter-clockwise where it is seen from.
    normals
        float32 (N, 3), unit vectors.
    colors
        uint8 (N, 3), RGB as shown on screens; stored linear with 16 bits, as glTF wants it.
    unit
        mm, cm or m, scaled to metres by the node; other units are taken for metres.

    Raises
    ------
    OutputError
        VI603 if an array has another dtype or shape, or holds what is not finite.
    """
    _check(points, faces, normals, colors)
    parts: dict[str, Array] = {"POSITION": points}
    if normals is not None:
        parts["NORMAL"] = normals
    if colors is not None:
        parts["COLOR_0"] = _linear(colors)
    indices = faces.astype("<u4")
    blocks = [part.astype(part.dtype.newbyteorder("<")).tobytes() for part in parts.values()]
    blocks.append(indices.tobytes())
    return _packed(_told(parts, indices, unit), b"".join(blocks))


def _check(points: Array, faces: Array, normals: Array | None, colors: Array | None) -> None:
    count = points.shape[0] if points.ndim else 0
    wanted = {"points": (points, "float32"), "normals": (normals, "float32"), "colors": (colors, "uint8")}
    for what, (array, dtype) in wanted.items():
        if array is not None and (array.dtype != dtype or array.shape != (count, 3)):
            raise inexact(f"GLB {what} are {array.dtype} {array.shape}; wants {dtype} ({count}, 3)")
        if array is not None and dtype == "float32" and not np.isfinite(array).all():
            raise inexact(f"GLB {what} hold values that are not finite")
    if faces.dtype not in (np.int32, np.uint32) or faces.ndim != 2 or faces.shape[1] != 3 or not len(faces):
        raise inexact(f"GLB faces are {faces.dtype} {faces.shape}; wants int32 or uint32 (M, 3)")
    if faces.min() < 0 or faces.max() >= count:
        raise inexact("GLB faces name points that there are not")


def _linear(colors: Array) -> Array:
    """uint16 RGBA, linear: four channels keep each vertex at a multiple of four bytes."""
    table = np.rint(65535 * linear_from_srgb(np.arange(256) / 255)).astype(np.uint16)
    return np.column_stack([table[colors], np.full(len(colors), 65535, np.uint16)])


def _told(parts: Mapping[str, Array], indices: Array, unit: str) -> dict[str, Any]:
    scale = METRES.get(unit, 1.0)
    accessors = [_accessor(index, name, part) for index, (name, part) in enumerate(parts.items())]
    accessors.append({"bufferView": len(parts), "componentType": _INT, "count": indices.size, "type": "SCALAR"})
    primitive = {
        "attributes": {name: index for index, name in enumerate(parts)}, "indices": len(parts), "material": 0,
    }  # fmt: skip
    views, start = [], 0
    for index, block in enumerate([*parts.values(), indices]):
        target = _INDICES if index == len(parts) else _VERTICES
        views.append({"buffer": 0, "byteOffset": start, "byteLength": block.nbytes, "target": target})
        start += block.nbytes
    turned = [scale, 0, 0, 0, 0, -scale, 0, 0, 0, 0, -scale, 0, 0, 0, 0, 1]
    return {
        "asset": {"version": "2.0", "generator": "visint", "extras": {"unit": unit}},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "matrix": turned}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [{"doubleSided": True, "extensions": {"KHR_materials_unlit": {}}}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": start}],
    }


def _accessor(index: int, name: str, part: Array) -> dict[str, Any]:
    told: dict[str, Any] = {"bufferView": index, "count": len(part), "type": f"VEC{part.shape[1]}"}
    told["componentType"] = _SHORT if name == "COLOR_0" else _FLOAT
    if name == "COLOR_0":
        told["normalized"] = True
    if name == "POSITION":
        told |= {"min": part.min(axis=0).tolist(), "max": part.max(axis=0).tolist()}
    return told


def _packed(told: dict[str, Any], body: bytes) -> bytes:
    text = json.dumps(told, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body += b"\0" * (-len(body) % 4)
    chunks = struct.pack("<I", len(text)) + _JSON + text + struct.pack("<I", len(body)) + _BIN + body
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks
