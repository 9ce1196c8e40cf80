"""PGM and PPM, plain and raw (the Netpbm formats P2, P3, P5 and P6), decoded here: maxval counts."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.io.limits import Limits
from visint.io.refusals import broken

__all__ = ["PnmHeader", "pnm_header", "pnm_samples"]

_GAP = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(rb"P([2356])" + _GAP + rb"(\d{1,9})" + _GAP + rb"(\d{1,9})" + _GAP + rb"(\d{1,9})\s")


class PnmHeader(NamedTuple):
    """What the file claims to be; ``start`` is where its samples begin."""

    plain: bool
    channels: int
    width: int
    height: int
    top: int
    start: int


def pnm_header(data: bytes, name: str) -> PnmHeader:
    """The header; raises InputError VI302 if it is no PGM or PPM header."""
    found = _HEADER.match(data)
    if found is None:
        raise broken(name, "has a damaged PGM/PPM header; wants P2, P3, P5 or P6, width, height and maxval")
    sort, width, height, top = (int(word) for word in found.groups())
    if not 0 < top <= 65535:
        raise broken(name, f"has maxval {top}; wants 1 to 65535")
    return PnmHeader(sort < 4, 3 if sort in (3, 6) else 1, width, height, top, found.end())


def pnm_samples(data: bytes, name: str, limits: Limits) -> tuple[Array, int]:
    """Samples uint8 or uint16, (H, W) or (H, W, 3) RGB, and the sample that means 1 (maxval).

    Raises
    ------
    InputError
        VI302 if samples are missing or above maxval, VI303 if the image is too large.
    """
    header = pnm_header(data, name)
    deep = header.top > 255
    limits.check_image(name, header.width, header.height, header.channels * (2 if deep else 1))
    flat = (_plain if header.plain else _raw)(data, header, name)
    if flat.max() > header.top:
        raise broken(name, f"has samples above its maxval {header.top}")
    shape = (header.height, header.width, header.channels)[: 3 if header.channels == 3 else 2]
    return flat.astype(np.uint16 if deep else np.uint8).reshape(shape), header.top


def _raw(data: bytes, header: PnmHeader, name: str) -> Array:
    count = header.width * header.height * header.channels
    dtype = np.dtype(">u2" if header.top > 255 else "u1")
    if len(data) - header.start < count * dtype.itemsize:
        raise broken(
            name,
            f"is cut off: it holds {len(data) - header.start} bytes of samples "
            f"where its header claims {count * dtype.itemsize}",
        )
    return np.frombuffer(data, dtype, count, header.start)


def _plain(data: bytes, header: PnmHeader, name: str) -> Array:
    count = header.width * header.height * header.channels
    body = data[header.start :]
    if body.translate(None, b"0123456789 \t\r\n\v\f") or re.search(rb"\d{7}", body):
        raise broken(name, "has something other than whole numbers up to 65535 among its samples")
    if len(body) < 2 * count - 1:
        raise broken(name, f"is cut off: it cannot hold the {count} samples its header claims")
    samples = np.fromstring(body.decode("ascii"), dtype=np.int32, sep=" ")
    if len(samples) < count:
        raise broken(name, f"is cut off: it holds {len(samples)} samples where its header claims {count}")
    return samples[:count]
