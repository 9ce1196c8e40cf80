"""TIFF: what a file claims to be, and whether it is of a sort that is read; nothing is decoded."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from visint.io.refusals import broken

__all__ = ["TiffHeader", "tiff_header"]

_TYPES = {1: "B", 3: "H", 4: "I"}  # BYTE, SHORT, LONG: all that the tags below may have
_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _PHOTOMETRIC, _FILL = 256, 257, 258, 259, 262, 266
_OFFSETS, _ORIENTATION, _SAMPLES, _ROWS, _COUNTS, _PLANAR = 273, 274, 277, 278, 279, 284
_PREDICTOR, _TILE_WIDTH, _TILE_HEIGHT, _TILE_OFFSETS, _TILE_COUNTS = 317, 322, 323, 324, 325
_FORMAT = 339
_READ = frozenset({_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _PHOTOMETRIC, _FILL, _OFFSETS, _ORIENTATION,
                   _SAMPLES, _ROWS, _COUNTS, _PLANAR, _PREDICTOR, _TILE_WIDTH, _TILE_HEIGHT, _TILE_OFFSETS,
                   _TILE_COUNTS, _FORMAT})  # fmt: skip
_COMPRESSIONS = {1: "none", 5: "LZW", 8: "Deflate", 32946: "Deflate", 32773: "PackBits"}
_COLOURS = {0: 1, 1: 1, 2: 3}  # white is zero, black is zero, RGB: samples that are colour
_DEPTHS = {(8, 1): "u1", (16, 1): "u2", (32, 3): "f4"}
_MOST_SEGMENTS = 1 << 20

Tags = Mapping[int, tuple[int, ...]]


class TiffHeader(NamedTuple):
    """The tags of the first image that decide how its samples are read.

    ``segment`` is (rows, columns) of a strip or tile, ``offsets`` and ``counts`` where each one lies.
    """

    width: int
    height: int
    channels: int
    depth: int
    dtype: np.dtype[Any]
    colours: int
    inverted: bool
    compression: int
    predictor: int
    tiled: bool
    segment: tuple[int, int]
    offsets: tuple[int, ...]
    counts: tuple[int, ...]
    pages: bool

    @property
    def floats(self) -> bool:
        """Whether samples are floating-point numbers."""
        return self.dtype.kind == "f"


def tiff_header(data: bytes, name: str) -> TiffHeader:
    """The header of the first image in a TIFF file.

    Raises
    ------
    InputError
        VI302 if it is cut off or damaged, or of a sort that is not read: planar, palette, CMYK, JPEG or fax
        compression, other depths than 8, 16 and 32-bit float.
    """
    order = "<" if data.startswith(b"II") else ">"
    tags, pages = _tags(data, order, name)
    width, height = (_one(tags, tag, 0, name) for tag in (_WIDTH, _HEIGHT))
    if not (0 < width < 1 << 31 and 0 < height < 1 << 31):
        raise broken(name, f"claims {width} × {height} pixels; wants at least 1 × 1")
    channels, colours, photometric = _colour(tags, name)
    depth, dtype = _depth(tags, channels, order, name)
    compression, predictor = _packing(tags, depth, dtype, name)
    segment, offsets, counts = _segments(tags, (height, width), name)
    return TiffHeader(
        width, height, channels, depth, dtype, colours, photometric == 0, compression, predictor,
        _TILE_WIDTH in tags, segment, offsets, counts, pages,
    )  # fmt: skip


def _tags(data: bytes, order: str, name: str) -> tuple[Tags, bool]:
    """The tags in the first directory that are read, and whether there is another directory."""
    cut = broken(name, "is a TIFF file cut off in its header")
    try:
        (start,) = struct.unpack_from(f"{order}I", data, 4)
        (number,) = struct.unpack_from(f"{order}H", data, start)
        found = {}
        for at in range(start + 2, start + 2 + 12 * number, 12):
            tag, type_, count = struct.unpack_from(f"{order}HHI", data, at)
            if tag in _READ and tag not in found:
                found[tag] = _values(data, order, at, (type_, count), name)
        (following,) = struct.unpack_from(f"{order}I", data, start + 2 + 12 * number)
    except struct.error:
        raise cut from None
    return found, following != 0


def _values(data: bytes, order: str, at: int, kind: tuple[int, int], name: str) -> tuple[int, ...]:
    type_, count = kind
    if type_ not in _TYPES or not 0 < count <= _MOST_SEGMENTS:
        raise broken(name, "has a damaged TIFF header: a tag of no such type or length")
    layout = f"{order}{count}{_TYPES[type_]}"
    where = at + 8
    if struct.calcsize(layout) > 4:
        (where,) = struct.unpack_from(f"{order}I", data, where)
    return struct.unpack_from(layout, data, where)


def _one(tags: Tags, tag: int, default: int, name: str) -> int:
    values = tags.get(tag, (default,))
    if len(set(values)) != 1:
        raise broken(name, f"has a TIFF header with {len(values)} different values for tag {tag}; wants one")
    return values[0]


def _colour(tags: Tags, name: str) -> tuple[int, int, int]:
    """Samples a pixel, how many of them are colour, and what they mean."""
    photometric = _one(tags, _PHOTOMETRIC, -1, name)
    channels = _one(tags, _SAMPLES, 1, name)
    colours = _COLOURS.get(photometric)
    if colours is None or not colours <= channels <= colours + 1:
        found = (
            f"is a TIFF file with a palette, CMYK, YCbCr or {channels} samples a pixel; save it as grey or RGB"
        )
        raise broken(name, found)
    if channels > 1 and _one(tags, _PLANAR, 1, name) != 1:
        raise broken(name, "is a TIFF file with one plane a colour; save it interleaved, or as PNG")
    if _one(tags, _ORIENTATION, 1, name) != 1 or _one(tags, _FILL, 1, name) != 1:
        raise broken(name, "is a TIFF file that is turned or mirrored by a tag; save it upright")
    return channels, colours, photometric


def _depth(tags: Tags, channels: int, order: str, name: str) -> tuple[int, np.dtype[Any]]:
    depth, format_ = _one(tags, _BITS, 1, name), _one(tags, _FORMAT, 1, name)
    if len(tags.get(_BITS, (1,))) not in (1, channels) or (depth, format_) not in _DEPTHS:
        sort = {1: "whole", 2: "signed", 3: "floating-point"}.get(format_, "other")
        found = (
            f"is a TIFF file of {depth}-bit {sort} samples; wants 8 or 16-bit whole or 32-bit floating-point"
        )
        raise broken(name, found)
    return depth, np.dtype(order + _DEPTHS[depth, format_])


def _packing(tags: Tags, depth: int, dtype: np.dtype[Any], name: str) -> tuple[int, int]:
    compression, predictor = _one(tags, _COMPRESSION, 1, name), _one(tags, _PREDICTOR, 1, name)
    if compression not in _COMPRESSIONS:
        wanted = ", ".join(dict.fromkeys(_COMPRESSIONS.values()))
        raise broken(
            name, f"is a TIFF file of compression {compression}", choices=f"compressions read: {wanted}"
        )
    if predictor not in ((1, 3) if dtype.kind == "f" else (1, 2)):
        raise broken(name, f"has a damaged TIFF header: no predictor {predictor} for {depth}-bit samples")
    return compression, predictor


def _segments(
    tags: Tags, size: tuple[int, int], name: str
) -> tuple[tuple[int, int], tuple[int, ...], tuple[int, ...]]:
    """(rows, columns) of a strip or tile, and the place and length of each."""
    height, width = size
    if _TILE_WIDTH in tags:
        segment = _one(tags, _TILE_HEIGHT, 0, name), _one(tags, _TILE_WIDTH, 0, name)
        offsets, counts = tags.get(_TILE_OFFSETS, ()), tags.get(_TILE_COUNTS, ())
    else:
        segment = min(_one(tags, _ROWS, height, name), height), width
        offsets, counts = tags.get(_OFFSETS, ()), tags.get(_COUNTS, ())
    if min(segment) < 1:
        raise broken(name, "has a damaged TIFF header: strips or tiles without a size")
    wanted = math.ceil(height / segment[0]) * math.ceil(width / segment[1])
    if not len(offsets) == len(counts) == wanted:
        found = f"has a damaged TIFF header: {len(offsets)} strips or tiles where its size asks for {wanted}"
        raise broken(name, found)
    return segment, offsets, counts
