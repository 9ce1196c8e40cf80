"""Albedo a region, from its brightest pixels or from all."""

from __future__ import annotations

import numpy as np
import pytest

from visint_shading.albedo import AlbedoOf
from visint_shading.reflectance.albedo import percentile_by_region

ALBEDO = 0.8


@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("name", ["sphere", "cylinder", "paraboloid", "saddle", "torus"])
def test_within_three_percent(view, name, noise):
    """A rough map is enough."""
    seen = view(name, noise=noise)
    found = seen.run(AlbedoOf, depth=seen.roughly()).albedo
    assert abs(np.median(found[seen.away]) / ALBEDO - 1) < 0.03


def test_where_nothing_faces_the_light(view):
    """An oblique light along the axis of a cylinder: no pixel comes nearer to it than 20°."""
    seen = view("cylinder", (0.0, float(np.sin(0.6)), -float(np.cos(0.6))))
    found = seen.run(AlbedoOf, depth=seen.depth).albedo
    assert abs(np.median(found[seen.away]) / ALBEDO - 1) < 0.03
    assert np.percentile(seen.image[seen.away], 99) < 0.9 * ALBEDO


def test_the_robust_maximum_is_no_average(view):
    """The printed average would be a third too small on a sphere (section 4.2, C(iii))."""
    seen = view("sphere")
    assert seen.image[seen.figure].mean() < 0.75 * ALBEDO
    assert abs(np.median(seen.run(AlbedoOf).albedo[seen.figure]) / ALBEDO - 1) < 0.03


def test_two_albedos_in_a_region_are_reported(view):
    """And nothing is trusted there."""
    seen = view("sphere")
    half = np.where(np.arange(192)[None] < 90, np.float32(1), np.float32(0.5))
    found = seen.run(AlbedoOf, depth=seen.depth, image=seen.image * half)
    assert found.several[seen.away].all()
    assert (found.reliability == 0).all()
    assert not seen.run(AlbedoOf, depth=seen.depth).several.any()


def test_each_region_has_its_own(view):
    """Painted in two halves, with the boundary known."""
    seen = view("sphere")
    right = np.arange(192)[None] >= 96
    regions = np.where(seen.regions > 0, 1 + right, 0).astype(np.int32)
    image = seen.image * np.where(right, np.float32(0.5), np.float32(1))
    found = seen.run(AlbedoOf, depth=seen.depth, image=image, regions=regions).albedo
    assert abs(found[seen.away & ~right].mean() / ALBEDO - 1) < 0.03
    assert abs(found[seen.away & right].mean() / (ALBEDO / 2) - 1) < 0.03


def test_boundaries_serve_where_there_are_no_regions(view):
    """The halves between them are regions."""
    seen = view("sphere")
    lines = np.zeros(seen.image.shape, bool)
    lines[:, 96] = True
    image = seen.image * np.where(np.arange(192)[None] > 96, np.float32(0.5), np.float32(1))
    found = seen.run(AlbedoOf, depth=seen.depth, image=image, regions=None, boundaries=lines).albedo
    values = np.unique(np.round(found[seen.away & ~lines], 3))
    assert values.size == 2


def test_percentiles_are_those_of_numpy():
    """By region, to the width of a histogram's step."""
    rng = np.random.default_rng(3)
    values = rng.uniform(0, 1, (40, 50)).astype(np.float32)
    labels = rng.integers(0, 4, (40, 50)).astype(np.int32)
    found = percentile_by_region(values, labels, 0.9)
    for label in (1, 2, 3):
        assert abs(found[label] - np.quantile(values[labels == label], 0.9)) < 0.01
