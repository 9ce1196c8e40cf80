"""Cross-sections of arcs: depth and slant on both sides, each from its own region alone."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint_lines.diagram import Diagram

__all__ = ["Sections", "Surfaces", "cut", "surfaces"]

STRIDE = 2
"""Points along an arc from one section to the next."""
FEW = 4
"""Samples of a face beyond the blur below which those within have to do."""
MARGIN = 3
"""Points at each end of an arc where no section is made: other arcs are too near."""


class Surfaces(NamedTuple):
    """The planes that fit around each pixel, inside its region.

    ``planes``: float64 (H, W, 3), nearness w = 1/Z and its slopes by column and row; ``labels``: int32 (H, W).
    """

    planes: Array
    labels: Array
    camera: Camera


class Sections(NamedTuple):
    """N sections across arcs; on axis 1 the left side, then the right.

    Parameters
    ----------
    arc, point
        int (N,): which arc, and the number of its point the section goes through.
    across
        float (N, 2): unit vector, columns and rows, from the left to the right.
    offset
        float (M,): distances from the arc, pixels.
    depth
        float (N, 2, M): relative depth in pixels, f (1 − w/w₀): linear across a plane. NaN is unknown.
    there
        bool (N, 2, M): the sample lies in the side's region, whether or not depth is known there.
    slant
        float (N, 2, M): angle by which the surface turns away from the viewer towards the arc, radians.
    """

    arc: Array
    point: Array
    across: Array
    offset: Array
    depth: Array
    slant: Array
    there: Array

    def wide(self, near: int) -> Array:
        """bool (N, 2): whether each side reaches beyond the ``near`` samples that are not to be believed."""
        return np.asarray(self.there[:, :, near:].sum(axis=2) >= (FEW if near else 0))

    def of(self, first: int, near: int) -> Sections:
        """The first samples beyond the ``near`` ones of each section; where those are too few, all it has."""
        there = self.there[:, :, near:]
        wide = there.sum(axis=2, keepdims=True) >= FEW
        keep = np.concatenate([np.broadcast_to(~wide, (*there.shape[:2], near)), np.ones_like(there)], axis=2)
        keep &= keep.cumsum(axis=2) <= np.where(wide, first, near + first)
        blank = np.where(keep, 0.0, np.nan)
        return self._replace(depth=self.depth + blank, slant=self.slant + blank, there=self.there & keep)


def surfaces(depth: Array, labels: Array, camera: Camera, radius: int) -> Surfaces:
    """Planes of 1/Z fitted in squares of ``radius`` pixels, never across a border of ``labels``."""
    from visint_lines import _kernels

    with np.errstate(divide="ignore", over="ignore"):
        nearness = np.where(depth > 0, 1 / depth.astype(np.float64), np.nan)
    nearness[~np.isfinite(nearness)] = np.nan
    return Surfaces(_kernels.planes_within(nearness, labels, radius), labels, camera)


def cut(diagram: Diagram, seen: Surfaces, offset: Array) -> Sections:
    """Sections of every arc, with samples ``offset`` pixels (M,) away from it on either side."""
    places, across, arc, index = _stations(diagram)
    signed = np.stack([-offset, offset])  # (2, M)
    spots = places[:, None, None] + signed[None, :, :, None] * across[:, None, None]
    sides = np.array([(a.left, a.right) for a in diagram.arcs], dtype=np.int64).reshape(-1, 2)[arc]
    nearness, slopes, rays, there = _read(spots, sides, seen)
    sight = np.broadcast_to((places - np.array([seen.camera.cx, seen.camera.cy]))[:, None, None], rays.shape)
    middle = np.nanmax(np.where(np.isfinite(nearness), nearness, -np.inf), axis=(1, 2), initial=-np.inf)
    scale = np.where(np.isfinite(middle) & (middle > 0), middle, np.nan)[:, None, None]
    depth = seen.camera.focal_length * (1 - nearness / scale)
    outward = np.stack([across, -across], axis=1)[:, :, None]
    slant = _slant(nearness, slopes, (rays, sight), outward, seen.camera)
    return Sections(arc, index, across, offset, depth, slant, there)


def _stations(diagram: Diagram) -> tuple[Array, Array, Array, Array]:
    """(points, unit vectors to the right, numbers of their arcs, of their points) where sections are made."""
    found = []
    for number, arc in enumerate(diagram.arcs):
        count = len(arc.points)
        margin = 0 if arc.closed else min(MARGIN, count // 5)
        index = np.arange(margin, count - margin, STRIDE)
        ahead, behind = np.minimum(index + 2, count - 1), np.maximum(index - 2, 0)
        along = arc.points[ahead] - arc.points[behind]
        along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
        right = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        found.append((arc.points[index], right, np.full(len(index), number), index))
    if not found:
        return np.empty((0, 2)), np.empty((0, 2)), np.empty(0, np.int64), np.empty(0, np.int64)
    places, across, arc_of, index_of = (np.concatenate(part) for part in zip(*found, strict=True))
    return places, across, arc_of, index_of


def _read(spots: Array, sides: Array, seen: Surfaces) -> tuple[Array, Array, Array, Array]:
    """(nearness, its slopes, place from the principal point, whether on the side) at ``spots`` (N, 2, M, 2)."""
    height, width = seen.labels.shape
    nearest = np.rint(spots).astype(np.int64)
    inside = ((nearest >= 0) & (nearest < np.array([width, height]))).all(axis=-1)
    column, row = np.clip(nearest[..., 0], 0, width - 1), np.clip(nearest[..., 1], 0, height - 1)
    own = inside & (seen.labels[row, column] == sides[:, :, None])
    planes = np.where(own[..., None], seen.planes[row, column], np.nan)
    off = spots - nearest
    nearness = planes[..., 0] + (planes[..., 1:] * off).sum(axis=-1)
    nearness = np.where(nearness > 0, nearness, np.nan)
    centre = np.array([seen.camera.cx, seen.camera.cy])
    return nearness, planes[..., 1:], spots - centre, own


def _slant(nearness: Array, slopes: Array, rays: tuple[Array, Array], outward: Array, camera: Camera) -> Array:
    """atan2(−n·b, −n·r): how far the normal n leans to ``outward`` b, seen along the ray r through the arc.

    One line of sight serves a whole section: along each sample's own a plane would seem to turn away.
    """
    own, sight = rays
    f = camera.focal_length
    normal = f * slopes  # a plane's w is −n·(u/f, v/f, 1) up to scale
    n_z = nearness - (own * slopes).sum(axis=-1)
    length = np.sqrt(1 + (sight**2).sum(axis=-1) / f**2)
    facing = ((normal * sight).sum(axis=-1) / f + n_z) / length
    return np.asarray(np.arctan2(-(normal * outward).sum(axis=-1), facing))
