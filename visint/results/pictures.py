"""Fields as pictures to look at: uint8 RGB (H, W, 3)."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from visint import io
from visint.arrays import Array
from visint.fields.boundary_kind import BoundaryKind
from visint.fields.evidence import known

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = [
    "BOUNDARY_COLORS",
    "UNKNOWN",
    "of_boundary_kinds",
    "of_confidence",
    "of_image",
    "of_mask",
    "of_normals",
    "of_reference",
    "of_regions",
    "of_scalar",
    "on_nothing",
    "reference",
    "span",
    "turbo",
]

UNKNOWN = 128
"""The grey of unknown pixels: no colour of the turbo map, and of the normals that of none."""


BOUNDARY_COLORS: Mapping[BoundaryKind, tuple[int, int, int]] = MappingProxyType(
    {
        BoundaryKind.NONE: (0, 0, 0),
        BoundaryKind.LIMB: (230, 75, 53),
        BoundaryKind.OCCLUDING: (245, 195, 60),
        BoundaryKind.CONVEX: (77, 187, 213),
        BoundaryKind.CONCAVE: (140, 120, 230),
        BoundaryKind.MARK: (160, 160, 160),
    }
)
"""The colour, sRGB, of each kind of boundary; any other number is black too."""


def span(value: Array) -> tuple[float, float]:
    """The range that a picture of ``value`` shows: the 2nd to the 98th percentile of the known.

    A constant lies in the middle of its range.
    """
    seen = value[known(value)]
    if not seen.size:
        return 0.0, 1.0
    low, high = (float(q) for q in np.percentile(seen.astype(np.float64), (2, 98)))
    half = max(1.0, abs(low)) / 2
    return (low, high) if high > low else (low - half, low + half)


def of_scalar(value: Array, low: float, high: float) -> Array:
    """A map (H, W) in the turbo colours from ``low`` (blue) to ``high`` (red); unknown is grey."""
    with np.errstate(invalid="ignore"):
        level = np.clip((value.astype(np.float64) - low) / (high - low), 0, 1)
    grey = np.nan_to_num(level * 255).astype(np.uint8)
    return np.where(known(value)[..., None], turbo(grey), np.uint8(UNKNOWN))


def turbo(level: Array) -> Array:
    """The turbo colours, uint8 (H, W, 3), of levels uint8 (H, W): 0 is blue, 255 is red."""
    import cv2

    return np.ascontiguousarray(cv2.applyColorMap(np.ascontiguousarray(level), cv2.COLORMAP_TURBO)[..., ::-1])


def of_confidence(value: Array) -> Array:
    """Confidence (H, W) in [0, 1] as grey: white is sure."""
    grey = np.clip(np.nan_to_num(value) * 255, 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=-1)


def of_normals(value: Array) -> Array:
    """Normals (H, W, 3) in the usual colours: red to the right, green up, blue towards the camera."""
    flipped = value * np.array([1, -1, -1], np.float32)
    rgb = np.nan_to_num((flipped + 1) * 127.5).astype(np.uint8)
    return np.where(known(value)[..., None], rgb, np.uint8(UNKNOWN))


def of_regions(value: Array) -> Array:
    """Regions (H, W) in colours that differ from label to label; boundaries are black."""
    mixed = value.astype(np.uint32) * np.uint32(2654435761)
    rgb = np.stack([(mixed >> shift) & 0x7F for shift in (8, 16, 24)], axis=-1) + 96
    return np.where((value == 0)[..., None], 0, rgb).astype(np.uint8)


def of_boundary_kinds(value: Array) -> Array:
    """Kinds of boundary (H, W), :class:`visint.fields.BoundaryKind`, each in its colour; black is none."""
    colors = np.zeros((256, 3), np.uint8)
    for kind, color in BOUNDARY_COLORS.items():
        colors[kind] = color
    return colors[value]


def of_mask(value: Array) -> Array:
    """A mask or boundaries (H, W): white where set."""
    return np.repeat((value.astype(np.uint8) * 255)[..., None], 3, axis=-1)


def of_image(value: Array) -> Array:
    """A linear image (H, W) or (H, W, 3) as it would look on a screen."""
    rgb = io.srgb_from_linear(value)
    return np.repeat(rgb[..., None], 3, axis=-1) if rgb.ndim == 2 else rgb


def reference(result: Result) -> tuple[str, Array] | None:
    """The reference view, the first image among the inputs, and the input's name; None if there is none."""
    for name, spec in result.graph.inputs.items():
        value: Any = result.inputs.get(name)
        first = value[0] if isinstance(value, tuple) and value else value
        if spec.kind in ("Image", "Color") and isinstance(first, np.ndarray):
            return name, first
    return None


def of_reference(result: Result) -> Array | None:
    """The reference view as a picture; None if there is none."""
    found = reference(result)
    return None if found is None else of_image(found[1])


def of_change(value: Array, most: float) -> Array:
    """A signed map (H, W): blue at −``most``, white at 0, red at ``most``; unknown is grey."""
    share = np.clip(np.nan_to_num(value.astype(np.float64) / most), -1, 1)[..., None]
    blue, red = np.array([33, 102, 172]), np.array([178, 24, 43])
    rgb = 255 - np.abs(share) * (255 - np.where(share < 0, blue, red))
    return np.where(known(value)[..., None], rgb, UNKNOWN).astype(np.uint8)


def on_nothing(picture: Array) -> Array:
    """A picture of lines, uint8 (H, W, 4): what is black in ``picture`` (H, W, 3) is transparent."""
    alpha = np.where(picture.any(axis=-1, keepdims=True), np.uint8(255), np.uint8(0))
    return np.concatenate([picture, alpha], axis=-1)
