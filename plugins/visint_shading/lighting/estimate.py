"""Where the light is, from brightness and the map's normals."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Light
from visint_shading.brightness.seen import Seen
from visint_shading.surface.orientation import Orientation

__all__ = ["LightFit", "estimated"]

PIXELS = 6000
ROUNDS = 6
GROUPS = 8
WORTH = 0.7
"""An ambient part must leave at most so much of what is left without it."""
LARGEST_ANGLE = 0.2
"""Radians. With a standard error of this size nothing is trusted any more."""


class LightFit(NamedTuple):
    """A distant light, ``ambient`` in parts of albedo, ``sigma`` its standard error in radians, and trust."""

    light: Light
    ambient: float
    sigma: float
    trust: float


class _Sample(NamedTuple):
    """Rows of (n, 1), brightness, region and spatial group of some pixels."""

    rows: Array
    brightness: Array
    region: Array
    group: Array


def estimated(view: Seen, surface: Orientation) -> LightFit | None:
    """The distant light that explains ``view`` best, each region with an albedo of its own; None if none does.

    E = ρ (a + n·l) by alternating least squares over albedos ρ and light l, robust against shadows and
    highlights. The ambient part a is kept only where it explains much more. The standard error is the
    jackknife's over eight parts of the view; trust falls with it and with what is left unexplained.
    """
    sample = _sample(view, surface)
    if sample.brightness.size < 60:
        return None
    bare, rest = _fit(sample, ambient=False)
    full, less = _fit(sample, ambient=True)
    better = less < WORTH * rest and 0.03 < full[3] < 1.5
    found, left = (full, less) if better else (bare, rest)
    if not float(np.linalg.norm(found[:3])) > 0.5 or found[2] >= 0:
        return None
    undecided = _angle(bare[:3], full[:3]) * np.clip(1.25 * (1 - less / max(rest, 1e-12)), 0, 1) * (not better)
    sigma = float(np.hypot(_standard_error(sample, found, ambient=better), undecided))
    explained = 1 - left / max(_without_shape(sample), 1e-9)
    trust = np.clip((explained - 0.5) / 0.35, 0, 1) * np.clip(1.5 - 1.5 * sigma / LARGEST_ANGLE, 0, 1)
    x, y, z = (float(part) for part in found[:3])
    return LightFit(Light.distant(x, y, z), float(found[3]) if better else 0.0, sigma, float(trust))


def _angle(one: Array, other: Array) -> float:
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(np.arccos(np.clip(one @ other / max(lengths, 1e-9), -1, 1)))


def _sample(view: Seen, surface: Orientation) -> _Sample:
    usable = (view.labels > 0) & np.isfinite(surface.normals[..., 2]) & (surface.normals[..., 2] < -0.25)
    rows, columns = np.nonzero(usable)
    step = max(1, rows.size // PIXELS)
    rows, columns = rows[::step], columns[::step]
    normals = surface.normals[rows, columns].astype(np.float64)
    _, region = np.unique(view.labels[rows, columns], return_inverse=True)
    group = _spread_out(rows, 2) + 2 * _spread_out(columns, GROUPS // 2)
    whole = np.column_stack([normals, np.ones(rows.size)])
    return _Sample(whole, view.even[rows, columns].astype(np.float64), region.ravel(), group)


def _spread_out(places: Array, parts: int) -> Array:
    """Which of ``parts`` equally full intervals each place lies in."""
    if not places.size:
        return places
    edges = np.quantile(places, np.linspace(0, 1, parts + 1)[1:-1])
    return np.searchsorted(edges, places)


def _fit(sample: _Sample, ambient: bool) -> tuple[Array, float]:
    """(l, a) float64 (4,) of one albedo a region, |l| = 1, and the mean squared relative residual."""
    rows = sample.rows if ambient else sample.rows * (1, 1, 1, 0)
    light, albedo = np.array([0, 0, -1, 0.0]), _albedos(sample, np.ones(sample.brightness.size))
    weight = np.ones(sample.brightness.size)
    for _ in range(ROUNDS):
        scaled = sample.brightness / albedo[sample.region]
        light = _solved(rows, scaled, weight)
        light = light / max(float(np.linalg.norm(light[:3])), 1e-9)
        shade = np.maximum(rows @ light, 0.02)
        albedo = _albedos(sample, shade, weight)
        lit = rows[:, :3] @ light[:3] > 0.1  # the rest is in its own shadow
        weight = _weights(sample, shade, albedo) * lit
    return light, _left(sample, shade, albedo)


def _weights(sample: _Sample, shade: Array, albedo: Array) -> Array:
    """Geman and McClure's: what is off by more than 0.15 of the albedo counts little."""
    return np.asarray(1 / (1 + ((sample.brightness / albedo[sample.region] - shade) / 0.15) ** 2) ** 2)


def _left(sample: _Sample, shade: Array, albedo: Array) -> float:
    """What is left, squares above 0.3² cut: a few highlights must not decide."""
    return float(np.minimum((sample.brightness / albedo[sample.region] - shade) ** 2, 0.09).mean())


def _albedos(sample: _Sample, shade: Array, weight: Array | float = 1.0) -> Array:
    top = np.bincount(sample.region, weight * sample.brightness * shade)
    return np.maximum(top / np.maximum(np.bincount(sample.region, weight * shade * shade), 1e-9), 1e-6)


def _solved(rows: Array, values: Array, weight: Array) -> Array:
    weighed = rows * weight[:, None]
    return np.asarray(np.linalg.solve(weighed.T @ rows + 1e-6 * np.eye(4), weighed.T @ values))


def _without_shape(sample: _Sample) -> float:
    """What a constant brightness a region leaves, in parts of its mean."""
    mean = _albedos(sample, np.ones(sample.brightness.size))
    return _left(sample, np.ones(sample.brightness.size), mean)


def _standard_error(sample: _Sample, found: Array, ambient: bool) -> float:
    """Radians: the jackknife's standard error of the direction, one part of the view left out each time."""
    rows = sample.rows if ambient else sample.rows * (1, 1, 1, 0)
    albedo = _albedos(sample, np.maximum(rows @ found, 0.02))
    scaled = sample.brightness / albedo[sample.region]
    weight = _weights(sample, np.maximum(rows @ found, 0.02), albedo)
    squares = 0.0
    for group in range(GROUPS):
        without = _solved(rows, scaled, weight * (sample.group != group))[:3]
        squares += _angle(without, found[:3]) ** 2
    return float(np.sqrt(squares * (GROUPS - 1) / GROUPS + _left_open(sample, weight, found[:3])))


def _left_open(sample: _Sample, weight: Array, light: Array) -> float:
    """Squared radians that no part of the view decides, as where all normals of a region lie in a plane.

    What errors of the normals (0.05 rad) make of the light in the direction, square to it, of which brightness
    says least once each region's albedo is free.
    """
    normals = sample.rows[:, :3]
    shade = np.maximum(normals @ light, 0.02)
    norm = np.maximum(np.bincount(sample.region, weight * shade**2), 1e-9)
    both = [np.bincount(sample.region, weight * shade * normals[:, k]) / norm for k in range(3)]
    free = normals - shade[:, None] * np.column_stack(both)[sample.region]
    known = (free * weight[:, None]).T @ free / max(float(weight.sum()), 1e-9)
    across = np.linalg.svd(light[None])[2][1:]
    return 0.05**2 * 0.05 / max(float(np.linalg.eigvalsh(across @ known @ across.T)[0]), 1e-5)
