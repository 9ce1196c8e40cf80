"""JPEG: header and wholeness.

Decoders fill a truncated file up with grey and say nothing, so its markers are followed to the end mark
first (ITU-T T.81, annex B).
"""

from __future__ import annotations

import re
from typing import NamedTuple

from visint.io.refusals import broken

__all__ = ["JpegHeader", "jpeg_header"]

_SOF = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_READ = frozenset({0xC0, 0xC1, 0xC2})  # baseline, extended and progressive, all Huffman coded
_SOS, _EOI = 0xDA, 0xD9
_ALONE = frozenset({0x01, *range(0xD0, 0xD9)})
_IN_SCAN = re.compile(rb"\xff+[^\x00\xff\xd0-\xd7]")  # a marker: neither a stuffed byte nor a restart
_MOST_SCANS = 100  # usual encoders write at most about twelve; each costs a pass over the image


class JpegHeader(NamedTuple):
    """The frame header, and how many bytes of coded samples follow it."""

    width: int
    height: int
    channels: int
    coded: int


def jpeg_header(data: bytes, name: str) -> JpegHeader:
    """What a JPEG file claims to be, its markers followed to the end mark; nothing is decoded.

    Raises
    ------
    InputError
        VI302 if it ends before its end mark, is of a sort that is not read (lossless, arithmetic, 12 bit,
        CMYK), or holds fewer bytes than an image of that size can have.
    """
    frame, coded, scans, at = b"", 0, 0, 2
    while True:
        marker, at = _marker(data, at, name)
        if marker == _EOI:
            break
        body = _segment(data, at, name)
        at += 2 + len(body)
        if marker in _SOF:
            frame = _frame(marker, body, name)
        elif marker == _SOS:
            end = _end_of_scan(data, at, name)
            coded, scans, at = coded + end - at, scans + 1, end
            if scans > _MOST_SCANS:
                raise broken(name, f"has more than {_MOST_SCANS} JPEG scans; wants one or about ten")
    return _whole(frame, coded, name)


def _marker(data: bytes, at: int, name: str) -> tuple[int, int]:
    """The next marker and where its segment begins."""
    while data[at : at + 1] == b"\xff":
        marker = data[at + 1] if at + 1 < len(data) else 0
        if marker not in _ALONE and marker != 0xFF:
            return marker, at + 2
        at += 1 if marker == 0xFF else 2
    if at >= len(data):
        raise broken(name, "is a JPEG file cut off before its end mark (EOI)")
    raise broken(name, "is a damaged JPEG file: no marker where one must stand")


def _segment(data: bytes, at: int, name: str) -> bytes:
    length = int.from_bytes(data[at : at + 2], "big")
    if length < 2 or at + length > len(data):
        raise broken(name, "is a JPEG file cut off inside its header, before its end mark (EOI)")
    return data[at + 2 : at + length]


def _frame(marker: int, body: bytes, name: str) -> bytes:
    if marker not in _READ or len(body) < 6 or body[0] != 8:
        raise broken(name, "is a lossless, arithmetic or 12-bit JPEG file; wants an ordinary 8-bit one, or PNG")
    if body[5] not in (1, 3):
        raise broken(name, f"is a JPEG file of {body[5]} channels (CMYK?); save it as RGB or grey")
    return body


def _end_of_scan(data: bytes, at: int, name: str) -> int:
    found = _IN_SCAN.search(data, at)
    if found is None:
        raise broken(name, "is a JPEG file cut off before its end mark (EOI)")
    return found.start()


def _whole(frame: bytes, coded: int, name: str) -> JpegHeader:
    if not frame or not coded:
        raise broken(name, "is a JPEG file without an image in it")
    height, width = int.from_bytes(frame[1:3], "big"), int.from_bytes(frame[3:5], "big")
    blocks = ((width + 7) // 8) * ((height + 7) // 8)
    if coded * 8 < blocks:  # a block of 8 × 8 samples takes one bit at the very least
        raise broken(name, f"holds too few bytes for the {width} × {height} pixels its header claims")
    return JpegHeader(width, height, frame[5], coded)
