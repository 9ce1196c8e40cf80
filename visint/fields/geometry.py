"""Depth, disparity, positions and normals of a rectified camera: what every cue needs.

All maps are float32 and registered to the left view; unknown is NaN. Depth is ``Z = f B / (d + doffs)``.
"""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields.camera import Camera
from visint.fields.evidence import DepthEvidence, DisparityEvidence

__all__ = [
    "back_project",
    "depth_evidence",
    "depth_from_disparity",
    "disparity_evidence",
    "disparity_from_depth",
    "normals_from_depth",
    "normals_from_slopes",
    "pixel_grid",
    "slopes_from_depth",
    "slopes_from_normals",
]


def depth_from_disparity(disparity: Array, camera: Camera) -> Array:
    """Depth (H, W), unit of the baseline, from disparity (H, W) in pixels.

    NaN where the disparity is NaN or puts the point at or behind infinity (d + doffs ≤ 0).
    """
    shifted = disparity.astype(np.float64) + camera.doffs
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = camera.focal_length * camera.baseline / shifted
    return _single(np.where(shifted > 0, depth, np.nan))


def disparity_from_depth(depth: Array, camera: Camera) -> Array:
    """Disparity (H, W) in pixels from depth (H, W); NaN where depth is NaN or not positive."""
    with np.errstate(divide="ignore", invalid="ignore"):
        disparity = camera.focal_length * camera.baseline / depth.astype(np.float64) - camera.doffs
    return _single(np.where(depth > 0, disparity, np.nan))


def _single(value: Array) -> Array:
    """float32, NaN where the value is too large to be one."""
    largest = np.finfo(np.float32).max
    return np.where(np.abs(value) <= largest, value, np.nan).astype(np.float32)


def depth_evidence(evidence: DisparityEvidence, camera: Camera) -> DepthEvidence:
    """The same evidence as depth, its sigma carried along: σ_Z = Z² σ_d / (f B)."""
    depth = depth_from_disparity(evidence.value, camera)
    with np.errstate(over="ignore"):  # almost at infinity sigma may be infinite: the evidence abstains
        sigma = depth * (depth * (evidence.sigma / np.float32(camera.focal_length * camera.baseline)))
    return DepthEvidence.of(depth, sigma, evidence.reliability)


def disparity_evidence(evidence: DepthEvidence, camera: Camera) -> DisparityEvidence:
    """The same evidence as disparity, its sigma carried along: σ_d = f B σ_Z / Z²."""
    disparity = disparity_from_depth(evidence.value, camera)
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        nearness = np.float32(camera.focal_length * camera.baseline) / evidence.value
        sigma = nearness * evidence.sigma / evidence.value
    return DisparityEvidence.of(disparity, sigma, evidence.reliability)


def pixel_grid(camera: Camera) -> tuple[Array, Array]:
    """(u − c_x, v − c_y): float32 (1, W) and (H, 1), pixels from the principal point."""
    across = np.arange(camera.width, dtype=np.float32) - np.float32(camera.cx)
    down = np.arange(camera.height, dtype=np.float32) - np.float32(camera.cy)
    return across[None, :], down[:, None]


def back_project(depth: Array, camera: Camera) -> Array:
    """Positions (H, W, 3) in the camera frame, unit of the baseline, from depth (H, W)."""
    across, down = pixel_grid(camera)
    f = np.float32(camera.focal_length)
    return np.stack([depth * across / f, depth * down / f, depth], axis=-1).astype(np.float32)


def slopes_from_depth(depth: Array) -> Array:
    """Depth change per pixel, float32 (H, W, 2): (∂Z/∂column, ∂Z/∂row).

    Central differences where both neighbours are known, one-sided at an edge of the known, NaN where
    neither neighbour is.
    """
    return np.stack([_difference(depth, 1), _difference(depth, 0)], axis=-1)


def _difference(depth: Array, axis: int) -> Array:
    pad = [(1, 1) if a == axis else (0, 0) for a in range(2)]
    steps = np.diff(np.pad(depth, pad, constant_values=np.nan), axis=axis)
    before, after = (steps[:-1], steps[1:]) if axis == 0 else (steps[:, :-1], steps[:, 1:])
    one_sided = np.where(np.isnan(before), after, before)
    both = (before + after) / 2
    return np.where(np.isnan(both), one_sided, both).astype(np.float32)


def normals_from_slopes(depth: Array, slopes: Array, camera: Camera) -> Array:
    """Unit normals (H, W, 3) facing the camera, of the perspective surface with these slopes per pixel.

    n ∝ (f Z_u, f Z_v, −(Z + (u−c_x) Z_u + (v−c_y) Z_v)); NaN where depth or a slope is.
    """
    across, down = pixel_grid(camera)
    zu, zv = slopes[..., 0], slopes[..., 1]
    f = np.float32(camera.focal_length)
    normal = np.stack([f * zu, f * zv, -(depth + across * zu + down * zv)], axis=-1)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = normal / length
    return np.where(unit[..., 2:] < 0, unit, np.nan).astype(np.float32)


def normals_from_depth(depth: Array, camera: Camera) -> Array:
    """Unit normals (H, W, 3) facing the camera, from depth (H, W); NaN where it is not known or not positive.

    Differences are taken of 1/Z, which is linear over the image of any plane: Z_u/Z = −Z ∂(1/Z)/∂u. So
    planes come out exact, on coarse levels and at the edge of the known too.
    """
    with np.errstate(divide="ignore", over="ignore"):
        nearness = _single(np.where(depth > 0, 1 / depth, np.nan))
    relative = -depth[..., None] * slopes_from_depth(nearness)
    return normals_from_slopes(np.ones_like(depth), relative, camera)


def slopes_from_normals(depth: Array, normals: Array, camera: Camera) -> Array:
    """The slopes per pixel (H, W, 2) that a surface at ``depth`` with these normals has.

    Z_u = −Z n_x / (f n·r) and Z_v = −Z n_y / (f n·r) with the ray r = ((u−c_x)/f, (v−c_y)/f, 1); NaN where
    the surface is seen edge-on or from behind (n·r ≥ 0).
    """
    across, down = pixel_grid(camera)
    f = np.float32(camera.focal_length)
    facing = normals[..., 0] * across / f + normals[..., 1] * down / f + normals[..., 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.where(facing < 0, -depth / (f * facing), np.nan)
    return (normals[..., :2] * scale[..., None]).astype(np.float32)
