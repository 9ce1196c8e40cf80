"""Loops over compressed bytes: what TIFF files are packed with beside zlib."""

from __future__ import annotations

import numba
import numpy as np

_CLEAR, _END, _MOST = 256, 257, 4096


@numba.njit(cache=True)
def unpackbits(packed, out):  # type: ignore[no-untyped-def]
    """PackBits (TIFF 6.0, section 9) into ``out``; how many bytes it gave, −1 if it is damaged."""
    at, done, wanted = 0, 0, len(out)
    while done < wanted and at < len(packed):
        head = packed[at]
        at += 1
        if head == 128:
            continue
        run = head + 1 if head < 128 else 257 - head
        if done + run > wanted:
            return -1
        if head < 128:
            if at + run > len(packed):
                return -1
            for i in range(run):
                out[done + i] = packed[at + i]
            at += run
        else:
            if at >= len(packed):
                return -1
            for i in range(run):
                out[done + i] = packed[at]
            at += 1
        done += run
    return done


@numba.njit(cache=True)
def unlzw(packed, out):  # type: ignore[no-untyped-def]
    """LZW (TIFF 6.0, section 13) into ``out``; how many bytes it gave, −1 if it is damaged.

    An entry of the table is a stretch of what is already out: where it begins, and its length.
    """
    begin = np.zeros(_MOST + 1, np.int64)
    length = np.ones(_MOST + 1, np.int64)
    size, bits, before = 258, 9, -1
    buffer, held, at, done = 0, 0, 0, 0
    last_begin, last_length = 0, 0
    while done < len(out):
        while held < bits:
            if at >= len(packed):
                return done
            buffer = ((buffer << 8) | packed[at]) & 0xFFFFFFFF
            held += 8
            at += 1
        code = (buffer >> (held - bits)) & ((1 << bits) - 1)
        held -= bits
        if code == _END:
            return done
        if code == _CLEAR:
            size, bits, before = 258, 9, -1
            continue
        if code > size or (before < 0 and code > 255) or (code == size and before < 0):
            return -1
        run = 1 if code < 256 else (last_length + 1 if code == size else length[code])
        if done + run > len(out):
            return -1
        if code < 256:
            out[done] = code
        else:
            source = last_begin if code == size else begin[code]
            for i in range(run):  # may read what it has just written: the first byte again
                out[done + i] = out[source + i]
        if before >= 0 and size < _MOST:
            begin[size] = last_begin
            length[size] = last_length + 1
            size += 1
        last_begin, last_length, before = done, run, code
        done += run
        if size >= (1 << bits) - 1 and bits < 12:  # TIFF's codes grow one early
            bits += 1
    return done
