"""TIFF: header checks and decoding of the first image (TIFF 6.0; predictor 3 by Adobe's Technical Note 3).

libtiff fills damaged strips up and OpenCV says nothing, so strips and tiles are decoded here, each of them
held against the number of bytes that the header asks for.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator

import numpy as np

from visint.arrays import Array
from visint.io.limits import Limits
from visint.io.refusals import broken
from visint.io.tiff_header import TiffHeader

__all__ = ["tiff_samples"]

_NONE, _LZW, _DEFLATE, _OLD_DEFLATE, _PACKBITS = 1, 5, 8, 32946, 32773


def tiff_samples(data: bytes, header: TiffHeader, name: str, limits: Limits) -> Array:
    """Samples as stored: uint8, uint16 or float32, (H, W) or (H, W, C), in this machine's byte order.

    Raises
    ------
    InputError
        VI302 if a strip or tile is missing or damaged, VI303 if the image is too large.
    """
    size, depth = (header.height, header.width), header.depth // 8
    limits.check_image(name, header.width, header.height, header.channels * depth)
    rows, columns = header.segment
    padded = math.ceil(size[0] / rows) * rows * math.ceil(size[1] / columns) * columns
    limits.check_size(name, padded * header.channels * depth)
    whole = np.empty((*size, header.channels), header.dtype)
    for index, (top, left) in enumerate(_corners(header)):
        height = rows if header.tiled else min(rows, size[0] - top)
        part = _segment(data, header, index, height, name)
        bottom, right = min(top + height, size[0]), min(left + columns, size[1])
        whole[top:bottom, left:right] = part[: bottom - top, : right - left]
    return whole[..., 0] if header.channels == 1 else whole


def _corners(header: TiffHeader) -> Iterator[tuple[int, int]]:
    rows, columns = header.segment
    for top in range(0, header.height, rows):
        for left in range(0, header.width, columns):
            yield top, left


def _segment(data: bytes, header: TiffHeader, index: int, rows: int, name: str) -> Array:
    """One strip or tile (rows, columns, channels), its prediction undone."""
    start, count = header.offsets[index], header.counts[index]
    columns = header.segment[1]
    wanted = rows * columns * header.channels * header.depth // 8
    if start + count > len(data):
        raise broken(name, "is a TIFF file cut off inside its samples")
    raw = _unpacked(memoryview(data)[start : start + count], header.compression, wanted)
    if raw is None:
        what = "tile" if header.tiled else "strip"
        raise broken(name, f"is a damaged TIFF file: {what} {index} does not hold the samples it must")
    return _predicted(raw, header, (rows, columns, header.channels))


def _unpacked(packed: memoryview, compression: int, wanted: int) -> Array | None:
    """uint8 (wanted,), or None where the data are damaged or too few."""
    if compression == _NONE:
        return np.frombuffer(packed[:wanted], np.uint8) if len(packed) >= wanted else None
    if compression in (_DEFLATE, _OLD_DEFLATE):
        return _inflated(packed, wanted)
    from visint.io import _kernels

    kernel = _kernels.unlzw if compression == _LZW else _kernels.unpackbits
    out = np.zeros(wanted, np.uint8)
    return out if kernel(np.frombuffer(packed, np.uint8), out) == wanted else None


def _inflated(packed: memoryview, wanted: int) -> Array | None:
    inflate = zlib.decompressobj()
    try:
        raw = inflate.decompress(packed, wanted)
        inflate.decompress(inflate.unconsumed_tail, 1)  # the checksum stands behind the last byte
    except zlib.error:
        return None
    return np.frombuffer(raw, np.uint8) if len(raw) == wanted else None


def _predicted(raw: Array, header: TiffHeader, shape: tuple[int, int, int]) -> Array:
    native = header.dtype.newbyteorder("=")
    if header.predictor == 3:
        return _float_predicted(raw, shape).astype(native)
    samples = raw.view(header.dtype).reshape(shape).astype(native, copy=False)
    return np.cumsum(samples, axis=1, dtype=native) if header.predictor == 2 else samples


def _float_predicted(raw: Array, shape: tuple[int, int, int]) -> Array:
    """Each row holds the differences of its samples' most significant bytes, then of the next ones, …"""
    rows, columns, channels = shape
    bytes_ = np.cumsum(raw.reshape(rows, columns * 4, channels), axis=1, dtype=np.uint8)
    planes = bytes_.reshape(rows, 4, columns * channels).transpose(0, 2, 1)
    return np.ascontiguousarray(planes).view(">f4").reshape(shape)
