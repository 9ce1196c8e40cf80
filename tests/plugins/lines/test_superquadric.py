"""Superquadrics of bodies whose sizes are known, and pictures of them."""

from __future__ import annotations

import numpy as np
import pytest

from visint.module import Context
from visint_lab.rays.finish import Plain
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Cylinder, Ellipsoid, Plane
from visint_lab.render.rendering import render
from visint_lines.superquadric.module import SuperquadricFit, SuperquadricInputs
from visint_lines.superquadric.shape import Superquadric, mesh, misfit


def seen(shape, turn):
    """(regions, rendering): a body before a wall."""
    things = (
        Thing(shape, Plain(0.8), (0.3, -0.2, 17.0), turned(*turn)),
        Thing(Plane(), Plain(0.5), (0.0, 0.0, 24.0), turned(0.1, -0.1)),
    )
    lamp = Lamp("distant", (-0.45, -0.6, -1.0), 0.12, shadows=False)
    pair = render(Scene("body", things, lamp, Rig.parallel((256, 256), 1.3 * 256, 0.7)), 1)
    return (pair.truth.depth < 21).astype(np.int32) + 1, pair


@pytest.mark.parametrize(
    ("shape", "turn", "sizes", "roundness"),
    [
        (Ellipsoid(3.0, 2.0, 1.6), (0.3, 0.5, 0.4), (1.6, 2.0, 3.0), 1.0),
        (Ellipsoid(2.0, 3.2, 2.5), (1.3, -0.5, 0.2), (2.0, 2.5, 3.2), 1.0),
        (Cylinder(1.8, 2.6), (1.1, 0.3, 0.35), (1.8, 1.8, 2.6), None),
        (Cylinder(2.2, 1.4), (0.7, 0.5, 0.0), (1.4, 2.2, 2.2), None),
    ],
)
def test_sizes_within_five_percent(shape, turn, sizes, roundness):
    """Half of the body is hidden: its half-axes follow from what is seen."""
    regions, pair = seen(shape, turn)
    given = SuperquadricInputs(regions=regions, depth=pair.truth.depth, camera=pair.camera, image=pair.left)
    found = SuperquadricFit().run(given, Context())
    ((label, fit),) = found.fits.of
    assert label == 2
    np.testing.assert_allclose(sorted(fit.shape.size), sizes, rtol=0.05)
    if roundness:
        np.testing.assert_allclose(fit.shape.roundness, roundness, atol=0.05)
    assert found.fitness[regions == 2].min() > 0.9
    assert not found.fitness[regions == 1].any()
    plain = 0.5 * pair.left[..., None]
    changed = (np.abs(found.drawing - plain) > 0.05).any(axis=-1)
    assert changed[regions == 2].mean() > 0.1
    assert changed[regions == 1].mean() < 0.05


def test_the_mesh_lies_on_the_surface():
    shape = Superquadric((3.0, 2.0, 1.0), (0.5, 1.2), (0.1, 0.7, -0.4), (1.0, 2.0, 20.0))
    np.testing.assert_allclose(misfit(shape, mesh(shape).reshape(-1, 3)), 0, atol=1e-3)
    np.testing.assert_allclose(Superquadric.of(shape.vector()).size, shape.size)
