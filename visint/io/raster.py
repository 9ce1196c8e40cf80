"""Rasters: the samples of a PNG, JPEG, TIFF, PGM or PPM file as they are stored."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from visint.arrays import Array, read_only
from visint.io.files import Note, read_bytes, shown, silent
from visint.io.formats import RASTERS, Format, format_of
from visint.io.jpeg import jpeg_header
from visint.io.limits import LIMITS, Limits
from visint.io.png import essential_png, png_header
from visint.io.pnm import pnm_samples
from visint.io.refusals import broken, unfit
from visint.io.tiff import tiff_samples
from visint.io.tiff_header import tiff_header

__all__ = ["Raster", "raster_of", "read_raster"]


@dataclass(frozen=True, slots=True)
class Raster:
    """Samples as stored.

    Parameters
    ----------
    samples
        uint8 or uint16, read-only: (H, W) grey, or (H, W, 3) in the order red, green, blue.
    top
        The sample that means 1: 255, 65535, or what a file of other depth says.
    """

    samples: Array
    top: int

    @property
    def grey(self) -> Array | None:
        """(H, W): the samples if they are grey, in one channel or three equal ones; else None."""
        if self.samples.ndim == 2:
            return self.samples
        red, green, blue = (self.samples[..., channel] for channel in range(3))
        return red if np.array_equal(red, green) and np.array_equal(green, blue) else None


def read_raster(path: str | Path, *, note: Note = silent, limits: Limits = LIMITS) -> Raster:
    """The samples of an image file, no curve undone and nothing scaled: for ground truth, labels, masks.

    Parameters
    ----------
    note
        Told if an alpha channel that is not everywhere opaque is dropped.

    Raises
    ------
    InputError
        VI301 if the file cannot be read, VI302 if it is broken, VI303 if too large, VI305 if it holds
        floating-point numbers.
    """
    name, data = shown(path), read_bytes(path, most=limits.most_bytes)
    format_ = format_of(data, name)
    if format_ not in RASTERS:
        raise unfit(name, f"is a {format_.value} file; wants PNG, JPEG, PGM/PPM or a TIFF of whole numbers")
    return raster_of(data, format_, name, note, limits)


def raster_of(data: bytes, format_: Format, name: str, note: Note, limits: Limits) -> Raster:
    """The samples in the bytes of a PNG, JPEG, TIFF or PGM/PPM file; raises as :func:`read_raster`."""
    if format_ is Format.PNM:
        samples, top = pnm_samples(data, name, limits)
    elif format_ is Format.JPEG:
        samples, top = _jpeg(data, name, limits), 255
    elif format_ is Format.TIFF:
        samples, top = _tiff(data, name, note, limits)
    else:
        samples, top = _png(data, name, note, limits)
    return Raster(read_only(samples), top)


def _jpeg(data: bytes, name: str, limits: Limits) -> Array:
    header = jpeg_header(data, name)
    limits.check_image(name, header.width, header.height, header.channels)
    pixels = _decoded(data, name, (header.height, header.width))
    return pixels if pixels.ndim == 2 else pixels[..., ::-1]


def _tiff(data: bytes, name: str, note: Note, limits: Limits) -> tuple[Array, int]:
    header = tiff_header(data, name)
    samples = tiff_samples(data, header, name, limits)
    top = int(np.iinfo(samples.dtype).max)
    if header.pages:
        note(f"{name}: it has several pages; the first one is read")
    if header.channels > header.colours:
        samples = _without_alpha(samples, name, note)
    return (samples.dtype.type(top) - samples if header.inverted else samples), top


def _without_alpha(pixels: Array, name: str, note: Note) -> Array:
    """The samples but for their last channel, which makes them transparent."""
    if (pixels[..., -1] != np.iinfo(pixels.dtype).max).any():
        note(f"{name}: its alpha channel is dropped; colours are taken as they are stored")
    return pixels[..., 0] if pixels.shape[2] == 2 else pixels[..., :-1]


def _png(data: bytes, name: str, note: Note, limits: Limits) -> tuple[Array, int]:
    header = png_header(data, name)
    limits.check_image(name, header.width, header.height, header.sample_bytes)
    pixels = _decoded(essential_png(data, header, name), name, (header.height, header.width))
    if pixels.ndim == 3 and pixels.shape[2] == 4:
        pixels = _without_alpha(pixels, name, note)
    if pixels.ndim == 3:
        pixels = pixels[..., 0] if header.grey else pixels[..., ::-1]
    if header.grey and header.depth < 8:  # the decoder spreads 1, 2 and 4 bits over 0 … 255
        top = (1 << header.depth) - 1
        return pixels // np.uint8(255 // top), top
    return pixels, int(np.iinfo(pixels.dtype).max)


def _decoded(data: bytes, name: str, size: tuple[int, int]) -> Array:
    """OpenCV's samples, unchanged, if they are what the header promised."""
    import cv2

    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        pixels = None
    if pixels is None or pixels.shape[:2] != size or pixels.dtype not in (np.uint8, np.uint16):
        raise broken(name, "is damaged: OpenCV cannot decode it")
    return pixels if pixels.ndim == 2 or pixels.shape[2] > 1 else pixels[..., 0]
