"""PFM: maps of 32-bit floats, bottom row first; unknown is infinite.

The header's third line is the byte order (negative: little-endian) and a scale that Middlebury's files
fill with a number for viewers. It is not a factor of the values, and is not multiplied in.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.io.limits import Limits
from visint.io.refusals import broken, inexact

__all__ = ["encode_pfm", "pfm_values"]

_HEADER = re.compile(rb"P([fF])\s+(\d{1,9})\s+(\d{1,9})\s+([-+]?[0-9.]{1,30}(?:[eE][-+]?\d{1,3})?)(?:\r\n|\s)")


class _Header(NamedTuple):
    width: int
    height: int
    channels: int
    little: bool
    start: int


def pfm_values(data: bytes, name: str, limits: Limits) -> Array:
    """float32 (H, W), or (H, W, 3) from a colour PFM, top row first, as stored: unknown is infinite.

    Raises
    ------
    InputError
        VI302 if the header is damaged or the file is shorter or longer than it says, VI303 if too large.
    """
    header = _header(data, name)
    limits.check_image(name, header.width, header.height, 4 * header.channels)
    count = header.width * header.height * header.channels
    if len(data) - header.start != 4 * count:
        found = f"holds {len(data) - header.start} bytes of values where its PFM header claims {4 * count}"
        raise broken(name, found)
    flat = np.frombuffer(data, "<f4" if header.little else ">f4", count, header.start)
    rows = flat.reshape(header.height, header.width, header.channels)[::-1]
    return np.array(rows[..., 0] if header.channels == 1 else rows, dtype=np.float32, order="C")


def _header(data: bytes, name: str) -> _Header:
    found = _HEADER.match(data)
    scale = _number(found[4]) if found else 0.0
    if found is None or scale == 0 or not math.isfinite(scale):
        raise broken(name, "has a damaged PFM header; wants Pf or PF, width, height, and a scale other than 0")
    return _Header(int(found[2]), int(found[3]), 3 if found[1] == b"F" else 1, scale < 0, found.end())


def _number(text: bytes) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def encode_pfm(values: Array) -> bytes:
    """A little-endian PFM file of exactly these values; NaN becomes infinite.

    Parameters
    ----------
    values
        float32, (H, W) or (H, W, 3).

    Raises
    ------
    OutputError
        VI603 for any other array.
    """
    shaped = values.ndim == 2 or (values.ndim == 3 and values.shape[2] == 3)
    if values.dtype != np.float32 or not shaped or not values.size:
        what = f"a {values.dtype} array of shape {values.shape}"
        raise inexact(f"{what} has no exact PFM; wants float32 (H, W) or (H, W, 3)")
    rows = np.where(np.isnan(values), np.float32(np.inf), values)[::-1].astype("<f4")
    mark = "Pf" if values.ndim == 2 else "PF"
    return f"{mark}\n{values.shape[1]} {values.shape[0]}\n-1.0\n".encode() + rows.tobytes()
