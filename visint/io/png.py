"""PNG: header, wholeness, and writing 8 and 16 bits.

The header is read and the compressed data are counted here before OpenCV allocates anything, and only the
chunks that make up the image are handed on: no colour profiles, animations or texts (ISO/IEC 15948).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.io.refusals import broken, inexact

__all__ = ["PngHeader", "encode_png", "essential_png", "png_header"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
_DEPTHS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
_IMAGE_CHUNKS = frozenset({b"IHDR", b"PLTE", b"tRNS", b"IDAT", b"IEND"})
_ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))


class PngHeader(NamedTuple):
    """The IHDR chunk."""

    width: int
    height: int
    depth: int
    colour: int
    compression: int
    filters: int
    interlace: int

    @property
    def grey(self) -> bool:
        """Whether samples are grey, with or without alpha."""
        return self.colour in (0, 4)

    @property
    def sample_bytes(self) -> int:
        """Bytes a pixel once decoded; a palette becomes RGBA."""
        channels = 4 if self.colour == 3 else _CHANNELS[self.colour]
        return channels * max(1, self.depth // 8)

    @property
    def raw_size(self) -> int:
        """How many bytes the compressed data must hold: each row its filter byte and its samples."""
        if not self.interlace:
            return self._rows(self.width, self.height)
        return sum(
            self._rows(-((x - self.width) // dx), -((y - self.height) // dy))
            for x, y, dx, dy in _ADAM7
            if self.width > x and self.height > y
        )

    def _rows(self, width: int, height: int) -> int:
        return height * (1 + (width * self.depth * _CHANNELS[self.colour] + 7) // 8)


def png_header(data: bytes, name: str) -> PngHeader:
    """What a PNG file claims to be; nothing is decoded.

    Raises
    ------
    InputError
        VI302 if the header is cut off or claims what no PNG may be.
    """
    if len(data) < 33 or data[12:16] != b"IHDR":
        raise broken(name, "is a PNG file cut off in its header")
    header = PngHeader(*struct.unpack(">IIBBBBB", data[16:29]))
    legal = header.depth in _DEPTHS.get(header.colour, ()) and header[4:6] == (0, 0) and header.interlace < 2
    if not legal or zlib.crc32(data[12:29]) != int.from_bytes(data[29:33], "big"):
        raise broken(name, "has a damaged PNG header")
    return header


def essential_png(data: bytes, header: PngHeader, name: str) -> bytes:
    """The same PNG with its image chunks alone, every one of them found whole.

    Raises
    ------
    InputError
        VI302 if the file ends before its end mark, a chunk's checksum is wrong, or there are fewer
        samples than the header claims.
    """
    kept, packed = [_SIGNATURE], []
    for kind, start, end in _chunks(data, name):
        if kind in _IMAGE_CHUNKS:
            if zlib.crc32(data[start + 4 : end - 4]) != int.from_bytes(data[end - 4 : end], "big"):
                raise broken(name, f"is a damaged PNG file: the checksum of its {kind.decode()} chunk is wrong")
            kept.append(data[start:end])
        if kind == b"IDAT":
            packed.append(memoryview(data)[start + 8 : end - 4])
    if not _holds(packed, header.raw_size):
        raise broken(name, f"holds fewer samples than the {header.width} × {header.height} its header claims")
    return b"".join(kept)


def _chunks(data: bytes, name: str) -> Iterator[tuple[bytes, int, int]]:
    """Type, start and end of each chunk up to the end mark."""
    start = len(_SIGNATURE)
    while start + 12 <= len(data):
        end = start + 12 + int.from_bytes(data[start : start + 4], "big")
        kind = data[start + 4 : start + 8]
        if end > len(data):
            break
        yield kind, start, end
        if kind == b"IEND":
            return
        start = end
    raise broken(name, "is a PNG file cut off before its end mark (IEND)")


def _holds(packed: list[memoryview], wanted: int) -> bool:
    """Whether the data inflate to ``wanted`` bytes or more, counted a megabyte at a time."""
    inflate, count = zlib.decompressobj(), 0
    try:
        for piece in packed:
            rest: bytes | memoryview = piece
            while rest and count < wanted:
                count += len(inflate.decompress(rest, 1 << 20))
                rest = inflate.unconsumed_tail
        while count < wanted and (more := inflate.decompress(b"", 1 << 20)):
            count += len(more)
    except zlib.error:
        return False
    return count >= wanted


def encode_png(array: Array) -> bytes:
    """A PNG file of exactly these values.

    Parameters
    ----------
    array
        uint8 or uint16, (H, W) or (H, W, 3) RGB; bool (H, W), written as 0 and 255; int32 (H, W) labels
        from 0 to 65535, written as 16 bits. Nothing else is taken: a float image would lose its values.

    Raises
    ------
    OutputError
        VI603 for any other array; says what would do.
    """
    import cv2

    samples = _samples(array)
    if samples.ndim == 3:
        samples = samples[..., ::-1]
    done, data = cv2.imencode(".png", np.ascontiguousarray(samples))
    if not done:
        raise inexact(f"OpenCV cannot encode a {array.dtype} array {array.shape} as PNG")
    return data.tobytes()


def _samples(array: Array) -> Array:
    shaped = array.size and (array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 3))
    if shaped and array.dtype in (np.uint8, np.uint16):
        return array
    if shaped and array.ndim == 2 and array.dtype == np.bool_:
        return array.astype(np.uint8) * np.uint8(255)
    if shaped and array.ndim == 2 and array.dtype == np.int32 and 0 <= array.min() <= array.max() <= 65535:
        return array.astype(np.uint16)
    found = (
        f"a {array.dtype} array of shape {array.shape} has no exact PNG; wants uint8 or uint16 (H, W) or "
        "(H, W, 3), bool (H, W), or int32 (H, W) labels from 0 to 65535. Floats keep their values as PFM or npz"
    )
    raise inexact(found)
