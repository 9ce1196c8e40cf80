"""A file as a graph input of a field kind: the one table of which format may be read as what."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from visint.arrays import SPECS, Array, ArraySpec
from visint.errors import InputError
from visint.io.calibration import read_camera
from visint.io.curves import check_gamma
from visint.io.files import Note, read_bytes, shown, silent
from visint.io.formats import RASTERS, STORED, Format, format_of
from visint.io.images import color_of, image_of, intensity
from visint.io.kitti import kitti_disparity
from visint.io.limits import LIMITS, Limits
from visint.io.maps import confidence_of, mask_of, regions_of
from visint.io.npy import npy_array
from visint.io.npz import npz_array
from visint.io.pfm import pfm_values
from visint.io.raster import Raster, raster_of
from visint.io.refusals import unfit
from visint.io.stored import conform, typed
from visint.io.tiff import tiff_samples
from visint.io.tiff_header import tiff_header

__all__ = ["read", "read_color", "read_image"]

_FLOATS = STORED | {Format.PFM, Format.FLOAT_TIFF}
_EXACT = STORED | {Format.PNG, Format.PNM, Format.TIFF}
_TAKES: Mapping[str, frozenset[Format]] = MappingProxyType(
    {
        "Image": _FLOATS | RASTERS,
        "Color": _FLOATS | RASTERS,
        "Depth": _FLOATS,
        "Relief": _FLOATS,
        "Disparity": _FLOATS | {Format.PNG},  # 16-bit, by KITTI's rule
        "Normals": _FLOATS,
        "Sigma": _FLOATS,
        "Incidence": _FLOATS,
        "Confidence": _EXACT | _FLOATS,
        "Mask": _EXACT,
        "Boundaries": _EXACT,
        "Regions": _EXACT,
    }
)
"""Formats by kind; any other array kind is read from npy and npz alone."""

_GIVEN = {
    "Light": "is given as x,y,z, not as a file",
    "Scalar": "is a number, not a file",
    "Flag": "is true or false, not a file",
    "Text": "is a text, not a file",
}


def read(
    path: str | Path,
    kind: str | ArraySpec,
    *,
    gamma: float | None = None,
    note: Note = silent,
    limits: Limits = LIMITS,
) -> Any:
    """A file as a graph input.

    Parameters
    ----------
    path
        PNG, JPEG, TIFF, PGM/PPM, PFM, npy or npz, told apart by content; a calibration for a Camera. From an
        npz file the array named like the kind in small letters is taken (``normals``), else its only one.
    kind
        A built-in field kind, or the spec of a plugin's own (read from npy and npz).
    gamma
        For Image and Color. None: 8-bit files are sRGB and the curve is undone, 16-bit and float files are
        linear. A number g: the stored value to the power g, for every format; 1 leaves it alone.
    note
        Called with one sentence for each thing that reading changed: alpha dropped, float64 rounded.
    limits
        The largest input; 64 MP and 512 MB unless told.

    Returns
    -------
    A :class:`visint.fields.Camera`, or a read-only C-contiguous array of the kind's dtype and shape: linear
    intensity in [0, 1] (colour becomes an Image by luminance), unknown NaN.

    Raises
    ------
    InputError
        VI301 if the file cannot be read, VI302 if it is broken, VI303 if it is too large, VI305 if it cannot
        be exactly what is wanted, VI306 if it is a wrong calibration.
    """
    if kind == "Camera":
        return read_camera(path)
    name = shown(path)
    spec = kind if isinstance(kind, ArraySpec) else _spec(kind, name)
    check_gamma(gamma)
    try:
        return _array(read_bytes(path, most=limits.most_bytes), spec, _Manner(name, gamma, note, limits))
    except MemoryError:
        raise InputError.of("VI303", "needs more memory than there is", where=name) from None


class _Manner(NamedTuple):
    """How one file is read, and what it is called."""

    name: str
    gamma: float | None
    note: Note
    limits: Limits


def _array(data: bytes, spec: ArraySpec, manner: _Manner) -> Array:
    name, gamma, note, limits = manner
    takes = _TAKES.get(spec.kind, STORED)
    if takes == STORED and _is_text(data):
        found = f"is text; a {spec.kind} is read from npy, npz"
        raise unfit(name, found, write='numpy.save("numbers.npy", numpy.loadtxt("numbers.txt"))')
    format_ = format_of(data, name)
    if format_ not in takes:
        wanted = ", ".join(sorted(one.value for one in takes))
        raise unfit(name, f"is {format_.value}; a {spec.kind} is read from {wanted}")
    if format_ in RASTERS:
        raster = raster_of(data, format_, name, note, limits)
        return conform(_from_raster(raster, spec.kind, name, gamma), spec, name, note)
    value = typed(_stored(data, format_, spec.kind, name, limits), spec, name, note)
    if spec.kind in ("Image", "Color"):
        value = intensity(value, 3 if spec.kind == "Color" else 1, gamma)
    return conform(value, spec, name, note)


def _is_text(data: bytes) -> bool:
    head = data[:512]
    return (
        b"\0" not in head and head.isascii() and not head.startswith((b"P2", b"P3", b"P5", b"P6", b"Pf", b"PF"))
    )


def read_image(
    path: str | Path, *, gamma: float | None = None, note: Note = silent, limits: Limits = LIMITS
) -> Array:
    """Linear intensity, float32 (H, W) in [0, 1]: :func:`read` as an ``Image``."""
    return np.asarray(read(path, "Image", gamma=gamma, note=note, limits=limits))


def read_color(
    path: str | Path, *, gamma: float | None = None, note: Note = silent, limits: Limits = LIMITS
) -> Array:
    """Linear RGB, float32 (H, W, 3) in [0, 1]: :func:`read` as a ``Color``."""
    return np.asarray(read(path, "Color", gamma=gamma, note=note, limits=limits))


def _spec(kind: str, name: str) -> ArraySpec:
    if kind in SPECS:
        return SPECS[kind]
    found = f"a {kind} {_GIVEN[kind]}" if kind in _GIVEN else f"cannot be read as {kind!r}: no such field kind"
    raise unfit(name, found, choices=f"kinds read from files: Camera, {', '.join(sorted(SPECS))}")


def _from_raster(raster: Raster, kind: str, name: str, gamma: float | None) -> Array:
    match kind:
        case "Image":
            return image_of(raster, gamma)
        case "Color":
            return color_of(raster, gamma)
        case "Disparity":
            return kitti_disparity(raster, name)
        case "Confidence":
            return confidence_of(raster, name)
        case "Regions":
            return regions_of(raster, name)
        case _:
            return mask_of(raster, name, kind)


def _stored(data: bytes, format_: Format, kind: str, name: str, limits: Limits) -> Array:
    if format_ is Format.PFM:
        return pfm_values(data, name, limits)
    if format_ is Format.FLOAT_TIFF:
        return tiff_samples(data, tiff_header(data, name), name, limits)
    if format_ is Format.NPY:
        return npy_array(data, name, limits)
    return npz_array(data, kind.rpartition(".")[2].lower(), name, limits)
