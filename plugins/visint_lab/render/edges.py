"""The line labels of the truth: what each edge of the image comes from.

Between neighbouring pixels that see different things the exact place of the change is found by casting more
rays (bisection), so that a limb, where the surface turns away smoothly, is told from an edge that occludes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visint_lab.render.probing import Prober, Sight

__all__ = ["CONCAVE", "CONVEX", "LIMB", "MARK", "NAMES", "NO_EDGE", "OCCLUDING", "SHADOW", "edge_map"]

NO_EDGE, LIMB, OCCLUDING, CONVEX, CONCAVE, MARK, SHADOW = range(7)
NAMES = ("none", "limb", "occluding", "convex crease", "concave crease", "mark", "shadow")
HALVINGS = 18
EDGE_ON, MESH_EDGE_ON = 0.05, 0.3  # cosines between normal and ray
INWARDS, FLAT = 1e-3, 1e-8  # parts of a pixel; a limb of 1000 pixels' radius turns by 1e-6 over that
GEOMETRY, ALBEDO, LIGHTING = 1, 2, 3

Flags = NDArray[np.bool_]
Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _End:
    """One end of the pairs under a look: image points and what is seen there."""

    u: Points
    v: Points
    sight: Sight

    def moved(self, where: Flags, to: _End) -> _End:
        """The end with ``to`` in its place where asked."""
        seen = _each(lambda yes, no: _choose(where, yes, no), to.sight, self.sight)
        return _End(np.where(where, to.u, self.u), np.where(where, to.v, self.v), seen)


def _each(change: Callable[..., NDArray[Any]], *sights: Sight) -> Sight:
    """A sight made of ``change`` of every one of the arrays."""
    return Sight(**{f.name: change(*(getattr(s, f.name) for s in sights)) for f in fields(Sight)})


def _choose(where: Flags, yes: NDArray[Any], no: NDArray[Any]) -> NDArray[Any]:
    return np.where(where.reshape(where.shape + (1,) * (yes.ndim - 1)), yes, no)


def edge_map(prober: Prober, sight: Sight) -> NDArray[np.uint8]:
    """uint8 (H, W): :data:`LIMB`, :data:`OCCLUDING`, :data:`CONVEX`, :data:`CONCAVE`, :data:`MARK`,
    :data:`SHADOW` or :data:`NO_EDGE`.

    A depth edge is marked at the pixel of the nearer surface, every other one at the left or upper pixel. Where
    several meet in a pixel the first of the list wins.
    """
    edges = np.zeros(sight.depth.shape, dtype=np.uint8)
    for axis in (0, 1):
        _mark_edges(edges, prober, sight, axis)
    return edges


def _mark_edges(edges: NDArray[np.uint8], prober: Prober, sight: Sight, axis: int) -> None:
    height, width = sight.depth.shape
    rows, columns = np.mgrid[:height, :width]
    pick = [slice(None, -1) if a == axis else slice(None) for a in (0, 1)]
    ahead = [slice(1, None) if a == axis else slice(None) for a in (0, 1)]
    first = _end_at(sight, rows[tuple(pick)], columns[tuple(pick)])
    second = _end_at(sight, rows[tuple(ahead)], columns[tuple(ahead)])
    reasons = _reasons(prober, first, second)
    chosen = reasons > 0
    first, second, reasons = _only(first, chosen), _only(second, chosen), reasons[chosen]
    labels, nearer_second = _labels(prober, first, second, reasons)
    at = (
        np.where(nearer_second, second.v, first.v).astype(int),
        np.where(nearer_second, second.u, first.u).astype(int),
    )
    for label in range(SHADOW, NO_EDGE, -1):
        hit = labels == label
        edges[at[0][hit], at[1][hit]] = label


def _end_at(sight: Sight, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> _End:
    seen = _each(lambda values: values[rows, columns], sight)
    return _End(columns.astype(float), rows.astype(float), seen)


def _only(end: _End, chosen: Flags) -> _End:
    return _End(end.u[chosen], end.v[chosen], _each(lambda values: values[chosen], end.sight))


def _reasons(prober: Prober, a: _End, b: _End) -> NDArray[np.int64]:
    """Why a pair may hold an edge: 0 for no reason."""
    there = (a.sight.thing >= 0) & (b.sight.thing >= 0)
    geometry = ~_same_face(a, b) | (there & (_leap(prober, a, b) > 2 * _footprint(prober, a, b)))
    reasons = np.where(a.sight.lit != b.sight.lit, LIGHTING, 0)
    reasons = np.where(a.sight.mark != b.sight.mark, ALBEDO, reasons)
    return np.where(geometry, GEOMETRY, np.where(there, reasons, 0))


def _same_face(a: _End, b: _End) -> Flags:
    same: Flags = (a.sight.thing == b.sight.thing) & (a.sight.face == b.sight.face)
    return same


def _footprint(prober: Prober, a: _End, b: _End) -> Points:
    """The size of a pixel on the nearer surface."""
    near: Points = np.fmin(a.sight.depth, b.sight.depth) / prober.view.focal_length
    return near


def _rays(prober: Prober, end: _End) -> Points:
    view = prober.view
    x, y = (end.u - view.cx) / view.focal_length, (end.v - view.cy) / view.focal_length
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def _leap(prober: Prober, a: _End, b: _End) -> Points:
    """How far either depth lies from the other's tangent plane, the smaller of the two."""
    ray_a, ray_b = _rays(prober, a), _rays(prober, b)

    def off(one: _End, ray: Points, far: _End, far_ray: Points) -> Points:
        normal = one.sight.normals
        with np.errstate(divide="ignore", invalid="ignore"):
            planar = one.sight.depth * (normal * ray).sum(-1) / (normal * far_ray).sum(-1)
        distance: Points = np.abs(far.sight.depth - planar)
        return distance

    leap: Points = np.fmin(off(a, ray_a, b, ray_b), off(b, ray_b, a, ray_a))
    return leap


def _bisected(prober: Prober, a: _End, b: _End, reasons: NDArray[np.int64]) -> tuple[_End, _End]:
    """The pairs drawn together around the change."""
    for _ in range(HALVINGS):
        u, v = (a.u + b.u) / 2, (a.v + b.v) / 2
        middle = _End(u, v, prober(u, v))
        with_a = _alike(a, middle, reasons)
        undecided = with_a == _alike(b, middle, reasons)
        closer = _gap(a, middle) < _gap(middle, b)
        to_a = np.where(undecided, closer, with_a)
        a, b = a.moved(to_a, middle), b.moved(~to_a, middle)
    return a, b


def _alike(end: _End, middle: _End, reasons: NDArray[np.int64]) -> Flags:
    one, two = end.sight, middle.sight
    albedo, lighting = one.mark == two.mark, one.lit == two.lit
    return np.where(
        reasons == GEOMETRY, _same_face(end, middle), np.where(reasons == ALBEDO, albedo, lighting)
    ).astype(bool)


def _gap(a: _End, b: _End) -> Points:
    gap = np.abs(a.sight.depth - b.sight.depth)
    nothing = (a.sight.thing < 0) & (b.sight.thing < 0)
    return np.where(nothing, 0.0, np.where(np.isnan(gap), np.inf, gap))


def _labels(
    prober: Prober, first: _End, second: _End, reasons: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Flags]:
    """(labels, whether the second pixel of the pair is the one to mark)."""
    a, b = _bisected(prober, first, second, reasons)
    torn = _gap(a, b) > 0.01 * _footprint(prober, a, b)
    nearer_second = torn & ~(a.sight.depth <= np.nan_to_num(b.sight.depth, nan=np.inf))
    geometry = np.where(
        torn, _contour(prober, (a, b), (first, second), nearer_second), _crease(prober, (a, b), (first, second))
    )
    bright = np.abs(a.sight.brightness - b.sight.brightness)
    shadow = np.where(bright > 0.02 * np.fmax(a.sight.albedo, 1e-6), SHADOW, NO_EDGE)
    labels = np.where(reasons == GEOMETRY, geometry, np.where(reasons == ALBEDO, MARK, shadow))
    return labels, nearer_second & (reasons == GEOMETRY)


def _contour(
    prober: Prober, close: tuple[_End, _End], pixels: tuple[_End, _End], nearer_second: Flags
) -> NDArray[np.int64]:
    """Limb where the nearer surface turns away until it is just seen edge-on; a flat face that is, has an edge.

    The normals of a mesh are never quite so: there it is enough that the surface is seen at a low angle and
    turns away within the pixel.
    """
    near, pixel = (pair[0].moved(nearer_second, pair[1]) for pair in (close, pixels))
    mesh = prober.of_mesh[near.sight.thing]
    ray = _rays(prober, near)
    slant = np.abs((near.sight.normals * ray).sum(-1)) / np.linalg.norm(ray, axis=-1)
    turned = (near.sight.normals * pixel.sight.normals).sum(-1) < np.cos(np.radians(0.5))
    lenient = _same_face(near, pixel) & turned & (slant < MESH_EDGE_ON) & mesh
    turns = mesh | _turns(prober, near, pixel)
    return np.where((slant < EDGE_ON) & turns | lenient, LIMB, OCCLUDING)


def _turns(prober: Prober, near: _End, pixel: _End) -> Flags:
    """Whether the surface bends a little way in from its edge, towards the middle of the pixel."""
    u, v = near.u + INWARDS * (pixel.u - near.u), near.v + INWARDS * (pixel.v - near.v)
    inner = _End(u, v, prober(u, v))
    bent = 1 - (near.sight.normals * inner.sight.normals).sum(-1)
    turns: Flags = _same_face(near, inner) & (bent > FLAT)
    return turns


def _crease(prober: Prober, close: tuple[_End, _End], pixels: tuple[_End, _End]) -> NDArray[np.int64]:
    """Convex where the two normals part in the direction from pixel to pixel, concave where they meet."""
    before, after = close[0].sight.normals, close[1].sight.normals
    bend = (before * after).sum(-1) < np.cos(np.radians(2.0))
    places = [end.sight.depth[..., None] * _rays(prober, end) for end in pixels]
    parting = ((after - before) * (places[1] - places[0])).sum(-1)
    return np.where(bend, np.where(parting > 0, CONVEX, CONCAVE), NO_EDGE)
