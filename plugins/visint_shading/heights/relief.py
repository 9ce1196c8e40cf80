"""The whole of Oliensis and Dupuis' method on what brightness says: a relief and its normals."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.fields.geometry import pixel_grid, slopes_from_depth
from visint_shading.heights.gradients import conics, square_to_light
from visint_shading.heights.propagation import propagated
from visint_shading.heights.singular import Singular, bends_of, singular_points
from visint_shading.lighting.rays import cosines
from visint_shading.photometry import Photometry
from visint_shading.surface.cone import onto_cone

__all__ = ["Relief", "relief_of"]


class Relief(NamedTuple):
    """Depth (H, W), NaN where no singular point leads, and normals (H, W, 3) on the cone of their brightness.

    ``singular`` holds the points it started from.
    """

    depth: Array
    normals: Array
    singular: Singular


def relief_of(found: Photometry, light: Light, depth: Array | None, otherwise: int, reach: float) -> Relief:
    """Depth of the surfaces in view, as ``found`` sees them under ``light``.

    ``depth`` is the map's in the same frame: it gives heights at singular points and says how the surface bends
    there, within ``reach`` pixels. Without it every point is as high as every other and bends as ``otherwise``
    says.
    """
    assert found.light is not None
    labels, camera = found.seen.labels, found.camera
    level = square_to_light(light, camera, found.distance)
    usable = np.where(np.isfinite(level) & np.isfinite(found.incidence), labels, 0).astype(np.int32)
    group, label = singular_points(found.incidence, _noise(found), usable)
    height, bend = _known(found, depth, level, group, reach)
    bend = np.where(np.isnan(height), otherwise, bend).astype(np.int8)
    bend[0] = 0
    singular = Singular(group, label, bend, np.nan_to_num(height))
    conic = conics(found.incidence, found.light, camera)
    rise = propagated(conic, usable, singular)
    ahead = np.exp(np.where(usable > 0, rise + level, np.nan))
    if depth is None:
        ahead = ahead / max(float(np.nanmedian(ahead)), 1e-9) if np.isfinite(ahead).any() else ahead
    return Relief(ahead.astype(np.float32), _normals(ahead, usable, found), singular)


def _noise(found: Photometry) -> Array:
    """Standard deviation (H, W) that noise alone gives incidence."""
    scale = np.maximum(found.albedo.value, 1e-6)[found.seen.labels]
    return np.asarray(found.seen.spread / scale)


def _known(
    found: Photometry, depth: Array | None, level: Array, group: Array, reach: float
) -> tuple[Array, Array]:
    """Height (NaN unknown) and bend of each group, from the map."""
    count = int(group.max(initial=0)) + 1
    if depth is None or found.orientation is None:
        return np.full(count, np.nan), np.zeros(count)
    with np.errstate(divide="ignore", invalid="ignore"):
        above = np.log(depth.astype(np.float64)) - level
    there = (group > 0) & np.isfinite(above)
    members = np.bincount(group[there], minlength=count)
    mean = np.bincount(group[there], above[there], minlength=count) / np.maximum(members, 1)
    slopes = _slopes(found.orientation.normals, found.camera) - slopes_from_depth(level.astype(np.float32))
    bend = bends_of(group, found.seen.labels, slopes, reach) * _facing(found, group, count)
    return np.where(members > 0, mean, np.nan), bend


def _facing(found: Photometry, group: Array, count: int) -> Array:
    """Bool by group: the map too says that it faces the light, within 16°."""
    assert found.orientation is not None
    assert found.light is not None
    cosine = cosines(found.orientation.normals, found.light)
    there = (group > 0) & np.isfinite(cosine)
    members = np.bincount(group[there], minlength=count)
    return np.asarray(np.bincount(group[there], cosine[there], minlength=count) > 0.96 * np.maximum(members, 1))


def _slopes(normals: Array, camera: Camera) -> Array:
    """∇lnZ a pixel (H, W, 2) of a surface with these normals."""
    across, down = pixel_grid(camera)
    f = np.float32(camera.focal_length)
    facing = normals[..., 0] * across / f + normals[..., 1] * down / f + normals[..., 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(normals[..., :2] / (-f * facing)[..., None])


def _normals(depth: Array, labels: Array, found: Photometry) -> Array:
    """Direction from the relief's own slopes, magnitude from brightness."""
    from visint_shading.surface.orientation import from_depth

    surface = from_depth(depth.astype(np.float32), None, labels, found.camera, found.seen.length)
    assert found.light is not None
    return onto_cone(surface.normals, found.light, found.incidence)[0]
