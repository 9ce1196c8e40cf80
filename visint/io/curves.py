"""From stored values to linear intensity and back: the sRGB curve, a power, or none; and luminance."""

from __future__ import annotations

import math

import numpy as np

from visint.arrays import Array
from visint.errors import UsageError

__all__ = ["check_gamma", "linear_from_srgb", "linear_samples", "luminance", "powered", "srgb_from_linear"]

_WEIGHTS = (0.2126, 0.7152, 0.0722)


def linear_from_srgb(value: Array) -> Array:
    """Linear intensity from sRGB values in [0, 1] (IEC 61966-2-1); any shape, floating dtype kept."""
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(value: Array) -> Array:
    """uint8 sRGB from linear intensity, any shape; clipped to [0, 1], unknown is 0: for pictures to look at."""
    linear = np.clip(np.nan_to_num(value, nan=0.0), 0, 1)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(255 * curve), dtype=np.uint8)


def check_gamma(gamma: float | None) -> None:
    """Refuse a gamma that is no positive number; UsageError VI701."""
    if gamma is not None and not (gamma > 0 and math.isfinite(gamma)):
        found = f"gamma is {gamma}; wants a number above 0, 1 for values that are linear already"
        raise UsageError.of("VI701", found)


def linear_samples(samples: Array, top: int, gamma: float | None) -> Array:
    """float32 linear intensity in [0, 1] from whole-numbered samples, any shape.

    Parameters
    ----------
    samples
        uint8 or uint16, at most ``top``.
    top
        The sample that means 1.
    gamma
        None: files of at most 8 bits are sRGB, deeper ones linear. A number: the value to that power;
        1 leaves it alone, more darkens the middle tones.
    """
    value = np.arange(top + 1, dtype=np.float64) / top
    own = linear_from_srgb(value) if top <= 255 else value
    table = own if gamma is None else value**gamma
    return np.asarray(table.astype(np.float32)[samples])


def powered(value: Array, gamma: float | None) -> Array:
    """float32 intensity from a float file: linear already unless ``gamma`` says otherwise."""
    return value if gamma in (None, 1) else np.asarray(value**gamma, dtype=np.float32)


def luminance(color: Array) -> Array:
    """float32 (H, W) from linear RGB float32 (H, W, 3): 0.2126 R + 0.7152 G + 0.0722 B (BT.709)."""
    total = color[..., 0] * np.float32(_WEIGHTS[0])
    for channel in (1, 2):
        total += color[..., channel] * np.float32(_WEIGHTS[channel])
    return np.asarray(total)  # white is exactly 1 in this order, and rounding keeps order: never above 1
