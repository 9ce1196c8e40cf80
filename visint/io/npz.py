"""npz: named arrays in a zip archive, as ``numpy.savez`` stores them."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from visint.arrays import Array
from visint.errors import InputError
from visint.io.files import read_bytes, shown
from visint.io.formats import Format, format_of
from visint.io.limits import LIMITS, Limits
from visint.io.npy import encode_npy, encode_text, npy_array, npy_header
from visint.io.refusals import broken, unfit

__all__ = ["encode_npz", "npz_array", "read_npz"]

UNIT = ".unit"
"""Ends the key of a unit, which stands beside the array it is of."""
_NO_UNITS: Mapping[str, str] = MappingProxyType({})
_EPOCH = (1980, 1, 1, 0, 0, 0)
_MOST_ENTRIES = 4096
_HEAD = 16_384
_ZIP_FAULTS = (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError, KeyError)


def read_npz(path: str | Path, *, limits: Limits = LIMITS) -> dict[str, Array]:
    """Every array of an npz file by its key; read-only.

    Raises
    ------
    InputError
        VI301 if it cannot be read, VI302 if it is damaged, VI303 if it unpacks to more than the limits.
    """
    name, data = shown(path), read_bytes(path, most=limits.most_bytes)
    if format_of(data, name) is not Format.NPZ:
        raise unfit(name, "is no npz file")
    with _opened(data, name, limits) as archive:
        keys = _keys(archive)
        return {key: _member(archive, entry, name, limits) for key, entry in keys.items()}


def npz_array(data: bytes, key: str, name: str, limits: Limits) -> Array:
    """The array named ``key`` of an npz file, or its only one; raises as :func:`read_npz`, VI305 if neither."""
    with _opened(data, name, limits) as archive:
        keys = _keys(archive)
        entry = keys.get(key) or (next(iter(keys.values())) if len(keys) == 1 else None)
        if entry is None:
            held = ", ".join(sorted(keys)[:20]) or "none"
            raise unfit(name, f"has no array {key!r}", choices=f"arrays in it: {held}")
        return _member(archive, entry, name, limits)


def _opened(data: bytes, name: str, limits: Limits) -> zipfile.ZipFile:
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except _ZIP_FAULTS:
        raise broken(name, "is a damaged or cut off npz file") from None
    entries = archive.infolist()
    if len(entries) > _MOST_ENTRIES:
        raise InputError.of(
            "VI303", f"has {len(entries)} entries; at most {_MOST_ENTRIES} are read", where=name
        )
    limits.check_size(name, sum(entry.file_size for entry in entries))
    return archive


def _keys(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """The arrays by key; a text beside one, its unit, is none."""
    found = {e.filename.removesuffix(".npy"): e for e in archive.infolist() if e.filename.endswith(".npy")}
    return {key: e for key, e in found.items() if not (key.endswith(UNIT) and key.removesuffix(UNIT) in found)}


def _member(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str, limits: Limits) -> Array:
    place = f"{name}[{shown(entry.filename)}]"
    try:
        with archive.open(entry) as stream:
            npy_header(stream.read(_HEAD), entry.file_size, place, limits)
        with archive.open(entry) as stream:  # yields no more than the size that was checked
            data = stream.read(entry.file_size)
            stream.read(1)  # at the end the checksum is held against the data
    except _ZIP_FAULTS:
        raise broken(place, "is damaged") from None
    return npy_array(data, place, limits)


def encode_npz(arrays: Mapping[str, Array], units: Mapping[str, str] = _NO_UNITS) -> bytes:
    """An npz file, uncompressed, of these arrays under these keys: the same arrays give the same bytes.

    Parameters
    ----------
    arrays
        Plain numbers or booleans of any shape, by names such as ``normals``.
    units
        Their units by the same names; ``numpy.load(file)["normals.unit"].item()`` gives one back.

    Raises
    ------
    OutputError
        VI603 for arrays of objects, texts or records.
    """
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for key in sorted(arrays):
            archive.writestr(zipfile.ZipInfo(f"{key}.npy", _EPOCH), encode_npy(arrays[key]))
            if key in units:
                archive.writestr(zipfile.ZipInfo(f"{key}{UNIT}.npy", _EPOCH), encode_text(units[key]))
    return packed.getvalue()
