"""Which format a file is in: by its first bytes, never by its name."""

from __future__ import annotations

from enum import Enum

from visint.io.refusals import broken

__all__ = ["RASTERS", "STORED", "Format", "binary_sort", "format_of"]


class Format(Enum):
    """A format that is read; its value is its name in messages."""

    PNG = "PNG"
    JPEG = "JPEG"
    PNM = "PGM/PPM"
    TIFF = "TIFF"
    FLOAT_TIFF = "floating-point TIFF"
    PFM = "PFM"
    NPY = "npy"
    NPZ = "npz"


RASTERS = frozenset({Format.PNG, Format.JPEG, Format.PNM, Format.TIFF})
"""Formats of whole numbers, 8 or 16 bit."""

STORED = frozenset({Format.NPY, Format.NPZ})
"""numpy's formats."""

_MARKS: tuple[tuple[bytes, Format], ...] = (
    (b"\x89PNG\r\n\x1a\n", Format.PNG),
    (b"\xff\xd8\xff", Format.JPEG),
    (b"P2", Format.PNM),
    (b"P3", Format.PNM),
    (b"P5", Format.PNM),
    (b"P6", Format.PNM),
    (b"II*\0", Format.TIFF),
    (b"MM\0*", Format.TIFF),
    (b"Pf", Format.PFM),
    (b"PF", Format.PFM),
    (b"\x93NUMPY", Format.NPY),
    (b"PK\x03\x04", Format.NPZ),
    (b"PK\x05\x06", Format.NPZ),
)
_STRANGERS = (
    (b"II+\0", "a BigTIFF file"),
    (b"MM\0+", "a BigTIFF file"),
    (b"GIF8", "a GIF file"),
    (b"BM", "a BMP file"),
    (b"RIFF", "a WebP or another RIFF file"),
    (b"v/1\x01", "an OpenEXR file"),
    (b"\x89HDF", "an HDF5 or new MATLAB file"),
    (b"MATLAB", "a MATLAB file"),
    (b"%PDF", "a PDF file"),
    (b"\x1f\x8b", "a gzip file"),
    (b"P1", "a PBM file"),
    (b"P4", "a PBM file"),
    (b"P7", "a PAM file"),
    (b"\x89PNG", "a PNG file damaged by a text-mode copy"),
)


def format_of(data: bytes, name: str) -> Format:
    """The format of a file's bytes.

    Raises
    ------
    InputError
        VI302 if it is none that is read, with what it seems to be; or a TIFF file of a sort that is not.
    """
    for mark, format_ in _MARKS:
        if data.startswith(mark):
            return _of_tiff(data, name) if format_ is Format.TIFF else format_
    known = ", ".join(format_.value for format_ in Format if format_ is not Format.FLOAT_TIFF)
    raise broken(name, f"is {_seems(data)}", choices=f"formats read: {known}")


def binary_sort(head: bytes) -> str | None:
    """What a file that should be text is, by its first bytes, if they are those of a binary format."""
    marks = [(mark, f"a {format_.value} file") for mark, format_ in _MARKS] + list(_STRANGERS)
    binary = ((mark, what) for mark, what in marks if not mark.isalnum() or mark in (b"RIFF", b"MATLAB"))
    return next((what for mark, what in binary if head.startswith(mark)), None)


def _of_tiff(data: bytes, name: str) -> Format:
    """A TIFF file holds whole numbers or floats: its header decides how it is read."""
    from visint.io.tiff_header import tiff_header  # numpy, which text files do without

    return Format.FLOAT_TIFF if tiff_header(data, name).floats else Format.TIFF


def _seems(data: bytes) -> str:
    for mark, what in _STRANGERS:
        if data.startswith(mark):
            return what
    head = data[:512]
    return "text, not an image" if head.isascii() and b"\0" not in head else "in no format that visint knows"
