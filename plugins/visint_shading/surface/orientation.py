"""How the map's surface is turned, freed from the noise of its depth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint.fields.geometry import pixel_grid
from visint_shading.brightness.evening import evened

__all__ = ["Orientation", "from_depth", "from_normals"]

STEEPEST = 6.0
"""Slopes of one pixel are cut here (80°): single wrong depths must not turn a neighbourhood."""


class Orientation(NamedTuple):
    """Unit normals float32 (H, W, 3) facing the camera, NaN unknown, and the weight (H, W) behind each."""

    normals: Array
    weight: Array


def from_depth(
    depth: Array, confidence: Array | None, labels: Array, camera: Camera, length: float
) -> Orientation:
    """Normals of ``depth`` (H, W) from slopes taken and evened inside regions.

    Slopes of ln Z, from differences of 1/Z, are averaged, not heights: planes stay exact to their edges.
    ``confidence`` weighs them; ``length`` is the window's standard deviation, pixels.
    """
    from visint_shading import _kernels

    with np.errstate(divide="ignore", invalid="ignore"):
        nearness = np.where(depth > 0, 1 / depth, np.nan).astype(np.float32)
    sure = np.ones_like(nearness) if confidence is None else 0.05 + np.nan_to_num(confidence)
    found = np.empty((3, *depth.shape), np.float32)
    _kernels.relative_slopes(nearness, sure.astype(np.float32), labels, found)
    steepest = STEEPEST / camera.focal_length * found[2]
    slopes = np.clip(found[:2], -steepest, steepest)
    mean, weight = evened(slopes, found[2], labels, length)
    return Orientation(_normals(mean, camera), np.where(labels > 0, weight, 0).astype(np.float32))


def _normals(slopes: Array, camera: Camera) -> Array:
    """Of slopes of ln Z a pixel: n ∝ (f p, f q, −(1 + x p + y q))."""
    from visint_shading import _kernels

    across, down = pixel_grid(camera)
    found = np.empty((*slopes.shape[1:], 3), np.float32)
    _kernels.normals_of_slopes(slopes, across.ravel(), down.ravel(), np.float32(camera.focal_length), found)
    return found


def from_normals(normals: Array, labels: Array, length: float) -> Orientation:
    """The same from normals (H, W, 3)."""
    known = np.isfinite(normals).all(axis=-1) & (labels > 0)
    weight = known.astype(np.float32)
    flat = np.ascontiguousarray(np.moveaxis(np.where(known[..., None], normals, 0), -1, 0), np.float32)
    mean, sure = evened(flat, weight, labels, length)
    mean = np.moveaxis(mean, 0, -1)
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = mean / np.linalg.norm(mean, axis=-1, keepdims=True)
    return Orientation(unit.astype(np.float32), np.where(labels > 0, sure, 0).astype(np.float32))
