"""The energy and its solver against surfaces that are known."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import Camera, Light
from visint.fields.geometry import depth_from_disparity, normals_from_depth
from visint_bayes.joint import _kernels
from visint_bayes.joint.brightness import Brightness
from visint_bayes.joint.cuts import cut_by
from visint_bayes.joint.domain import Domain
from visint_bayes.joint.energy import Recipe, Setting, minimum, slopes_of
from visint_bayes.joint.multigrid import Multigrid
from visint_bayes.joint.photometry import views_of
from visint_bayes.joint.slant import lighting, normals_of_slopes

SIZE = 48
CAMERA = Camera(focal_length=150, cx=23.5, cy=23.5, baseline=10, width=SIZE, height=SIZE, unit="mm")
Y, X = np.mgrid[:SIZE, :SIZE].astype(float)
DISC = (Y - 23.5) ** 2 + (X - 23.5) ** 2 < 20**2


def blank(domain, stereo, **more):
    """A setting without any data: two black images."""
    black = np.zeros((SIZE, SIZE), np.float32)
    views = views_of((black, black), (domain.inside, domain.inside), 0.02)
    none, zero = np.zeros((SIZE, SIZE), bool), np.zeros((SIZE, SIZE), np.float32)
    given = {"gap": zero, "hidden": none, "unseen": none, "adrift": none, "camera": CAMERA, **more}
    return Setting(domain, views, stereo.astype(np.float32), **given)


def stencil(domain, data, bending):
    matrix = np.zeros((*domain.inside.shape, 25), np.float32)
    plate = np.full(domain.inside.shape, bending, np.float32)
    rows = np.zeros((*domain.inside.shape, 3), np.float32)
    joined = (domain.inside, domain.across, domain.down)
    _kernels.assemble(*joined, (data * domain.inside).astype(np.float32), plate, plate, plate, rows, matrix)
    return matrix


def dense(matrix):
    """The same as a full matrix, by its definition."""
    height, width = matrix.shape[:2]
    full = np.zeros((height * width, height * width))
    for y, x, k in np.argwhere(matrix):
        v, u = y + k // 5 - 2, x + k % 5 - 2
        full[y * width + x, v * width + u] = matrix[y, x, k]
    return full


@pytest.mark.parametrize("cut", [False, True])
def test_the_multigrid_solves_the_system(cut):
    """Against a dense solution, with and without a cut through the disc."""
    y, x = np.mgrid[:20, :20]
    disc = (y - 9.5) ** 2 + (x - 9.5) ** 2 < 9**2
    domain = cut_by(disc, (1 + cut * (x > 9 + 2 * np.sin(y / 3))).astype(np.int32))
    assert domain.pieces.max() == (2 if cut else 1)
    rng = np.random.default_rng(1)
    matrix = stencil(domain, 0.01 + 0.2 * (rng.random((20, 20)) < 0.2), 100.0)
    wanted = rng.standard_normal((20, 20)) * disc
    found = Multigrid(matrix, domain.pieces).solve(wanted, 1e-6, 60)
    full = dense(matrix) + np.diag(~disc.ravel())
    exact = np.linalg.solve(full, wanted.ravel()).reshape(20, 20)
    assert np.abs((found - exact)[disc]).max() < 1e-3 * np.abs(exact[disc]).max()


def test_the_matrix_is_symmetric_and_planes_cost_nothing():
    """Plate and twist of a linear field are 0, up to the rounding of single precision."""
    y, x = np.mgrid[:20, :20]
    disc = (y - 9.5) ** 2 + (x - 9.5) ** 2 < 9**2
    full = dense(stencil(Domain.of(disc), 0.0, 1.0))
    assert np.array_equal(full, full.T)
    plane = np.where(disc, 2 + 0.3 * x - 0.2 * y, 0).ravel()
    assert np.abs((full @ plane)[disc.ravel()]).max() < 1e-4


def test_a_plane_stays_exactly_where_it_is():
    """Anchored to a plane and bent by nothing the surface is that plane: plates in disparity are exact."""
    plane = 40 + 0.1 * X - 0.05 * Y
    found = minimum(blank(Domain.of(DISC), plane), Recipe(0.03), np.full_like(plane, 40))
    assert np.abs((found - plane)[DISC]).max() < 0.02


def test_a_cut_keeps_two_surfaces_apart():
    """Two planes 6 px apart with a cut between them: neither pulls at the other."""
    right = X > 23
    planes = np.where(right, 46.0, 40 + 0.1 * (X - 23))
    across = np.zeros((SIZE, SIZE), bool)
    across[:, 23] = True
    rough = planes + 0.1 * np.random.default_rng(0).standard_normal(planes.shape)
    cut = minimum(blank(Domain.of(DISC, across), rough), Recipe(0.03))
    joined = minimum(blank(Domain.of(DISC), rough), Recipe(0.03, crease=100.0))
    edge = DISC & (np.abs(X - 23.5) < 3)
    assert np.abs((cut - planes)[edge]).max() < 0.3
    assert np.abs((joined - planes)[edge]).max() > 1


def test_incidence_is_that_of_the_normals():
    """c = n·l from disparity slopes agrees with normals from depth, and its derivatives with differences."""
    disparity = (30 + 0.2 * X - 0.1 * Y + 0.002 * (X - 20) ** 2).astype(np.float32)
    domain = Domain.of(np.ones((SIZE, SIZE), bool))
    slopes = slopes_of(domain, disparity.astype(float))
    own = normals_of_slopes(disparity, slopes, CAMERA)
    other = normals_from_depth(depth_from_disparity(disparity, CAMERA), CAMERA)
    inner = np.s_[2:-2, 2:-2]
    assert np.abs(own - other)[inner].max() < 1e-4
    light = Light.distant(0.3, -0.2, -1)
    lit = lighting(disparity, slopes, CAMERA, light)
    for way, derivative in enumerate((lit.by_u, lit.by_v)):
        moved = slopes.copy()
        moved[..., way] += 1e-3
        change = (lighting(disparity, moved, CAMERA, light).cosine.astype(float) - lit.cosine) / 1e-3
        assert np.abs(change - derivative)[inner].max() < 5e-3


def test_exact_incidence_lifts_a_sphere_out_of_a_flat_start():
    """With the true n·l and little else, the error of a flattened sphere falls to a tenth."""
    radius, far = 9.0, 50.0
    rays = np.stack([(X - 23.5) / 150, (Y - 23.5) / 150, np.ones_like(X)], axis=-1)
    a, b, c = (rays**2).sum(-1), -2 * far * rays[..., 2], far**2 - radius**2
    root = b**2 - 4 * a * c
    inside = root > 0.15 * root.max()
    depth = np.where(inside, (-b - np.sqrt(np.maximum(root, 0))) / (2 * a), far)
    true = 1500 / depth
    normals = rays * depth[..., None] - np.array([0, 0, far])
    light = Light.distant(0.1, 0.2, -1)
    incidence = (normals / radius) @ np.asarray(light.vector)
    known = Brightness(incidence.astype(np.float32), np.full(X.shape, 0.05, np.float32), light)
    flat = np.where(inside, true[inside].mean() + 0.6 * (true - true[inside].mean()), 30)
    setting = blank(Domain.of(inside), flat, brightness=known, zoom=0.3)
    found = minimum(setting, Recipe(1e-4, 1.0, crease=10.0, turns=8), flat)

    def shape(surface):
        return (surface - surface[inside].mean() - (true - true[inside].mean()))[inside].std()

    assert shape(found) < 0.1 * shape(flat)


def test_shading_leaves_the_gauge_to_the_anchor():
    """Brightness says nothing about the disparity as a whole: it stays that of the stereo."""
    plane = np.full((SIZE, SIZE), 40.0)
    light = Light.distant(0, 0, -1)
    known = Brightness(np.full(X.shape, 0.9, np.float32), np.full(X.shape, 0.05, np.float32), light)
    tilted = plane + 0.05 * (X - 23.5)
    found = minimum(blank(Domain.of(DISC), tilted, brightness=known), Recipe(0.003, 1.0), tilted)
    assert abs(float((found - tilted)[DISC].mean())) < 0.05
