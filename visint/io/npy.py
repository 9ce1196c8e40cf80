"""npy: one array as numpy stores it, never unpickled; its size is checked before memory is taken."""

from __future__ import annotations

import io
import math
import warnings
from typing import Any

import numpy as np
from numpy.lib import format as npy_format

from visint.arrays import Array, read_only
from visint.io.limits import Limits
from visint.io.refusals import broken, inexact

__all__ = ["encode_npy", "encode_text", "npy_array", "npy_header"]

_PLAIN = "biufc"
_HEADER_BYTES = 16_384
_HEADERS = {(1, 0): npy_format.read_array_header_1_0, (2, 0): npy_format.read_array_header_2_0}


def npy_array(data: bytes, name: str, limits: Limits) -> Array:
    """The array of an npy file: of numbers or booleans, any shape, in this machine's byte order; read-only.

    Raises
    ------
    InputError
        VI302 if it is damaged, holds objects or records, or more or fewer bytes than its header claims;
        VI303 if it is too large.
    """
    shape, fortran, dtype, start = npy_header(data[:_HEADER_BYTES], len(data), name, limits)
    count = math.prod(shape)
    flat = np.frombuffer(data, dtype, count, start) if count else np.empty(0, dtype)
    return read_only(flat.reshape(shape, order="F" if fortran else "C").astype(dtype.newbyteorder("=")))


def npy_header(
    head: bytes, held: int, name: str, limits: Limits
) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    """Shape, Fortran order, dtype and where the values begin, from a file's first 16 KB.

    ``held`` is how many bytes the file has in all; raises as :func:`npy_array`.
    """
    shape, fortran, dtype, start = _header(head, name)
    size = math.prod(shape) * dtype.itemsize
    limits.check_size(name, size)
    if held - start != size:
        raise broken(name, f"holds {held - start} bytes of values where its npy header claims {size}")
    return shape, fortran, dtype, start


def _header(head: bytes, name: str) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    stream = io.BytesIO(head)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            version = npy_format.read_magic(stream)
            shape, fortran, dtype = _HEADERS[version](stream)
    except Exception:  # the header is a Python literal: a hostile one fails in many ways
        raise broken(name, "has a damaged npy header") from None
    if dtype.kind not in _PLAIN or dtype.names or dtype.subdtype:
        raise broken(name, f"holds {'objects' if dtype.hasobject else dtype}; wants plain numbers or booleans")
    if any(type(n) is not int or n < 0 for n in shape) or len(shape) > 32:
        raise broken(name, "has a damaged npy header: no such shape")
    return shape, fortran, dtype, stream.tell()


def encode_npy(array: Array) -> bytes:
    """An npy file of exactly this array: plain numbers or booleans, any shape.

    Raises
    ------
    OutputError
        VI603 for arrays of objects, texts or records.
    """
    if array.dtype.kind not in _PLAIN:
        raise inexact(f"an array of {array.dtype} is not written; wants plain numbers or booleans")
    return _written(np.asarray(array, order="C"))


def encode_text(text: str) -> bytes:
    """An npy file of one text, read by ``numpy.load(…).item()``: no pickle is in it."""
    return _written(np.array(text, dtype=f"<U{max(1, len(text))}"))


def _written(array: Array) -> bytes:
    stream = io.BytesIO()
    npy_format.write_array(stream, array, version=(1, 0), allow_pickle=False)
    return stream.getvalue()
