"""How moments change under a change of view, and what that tells: exact, from the equations."""

from __future__ import annotations

import numpy as np

from visint_texture.geometry.canonical import canonical
from visint_texture.geometry.orientation import candidates, nearest, normal_of, slant_and_tilt, wrapped
from visint_texture.geometry.tangent import (
    Positions,
    log_moments,
    normal_of_slopes,
    slopes_of_normal,
    surface_log_moments,
    to_surface,
)
from visint_texture.geometry.transform import (
    affine,
    affine_parts,
    image_from_surface,
    moments_under,
    surface_from_image,
)
from visint_texture.geometry.viewing import normal_candidates

N = 2000


def waves(rng: np.random.Generator, count: int = 30) -> np.ndarray:
    """Frequencies (N, count, 2) of random textures, each with its own scale and direction."""
    shape = rng.standard_normal((N, 2, 2))
    return np.einsum("nij,nkj->nki", shape, rng.standard_normal((N, count, 2)))


def moments_of(frequencies: np.ndarray) -> np.ndarray:
    """(g_x, 2E[u_x u_y], g_y), straight from the definition."""
    x, y = frequencies[..., 0], frequencies[..., 1]
    return np.stack([(x * x).mean(-1), 2 * (x * y).mean(-1), (y * y).mean(-1)], axis=-1)


def views(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slants, tilts and the maps from image to surface that they make: stretch 1/cos σ along the tilt."""
    slant, tilt = rng.uniform(0.02, 1.4, N), rng.uniform(-np.pi, np.pi, N)
    along = np.stack([np.cos(tilt), np.sin(tilt)], axis=-1) / np.cos(slant)[:, None]
    across = np.stack([-np.sin(tilt), np.cos(tilt)], axis=-1)
    return slant, tilt, np.stack([along, across], axis=-2)


def test_two_thousand_affine_maps():
    """Frequencies moved one by one give the moments that the law of transformation gives, to 1e-6."""
    rng = np.random.default_rng(0)
    maps = affine(
        rng.uniform(0.3, 3, N), rng.uniform(-3, 3, N), rng.uniform(1.02, 4, N), rng.uniform(-1.5, 1.5, N)
    )
    texture = waves(rng)
    seen = moments_of(np.einsum("nji,nkj->nki", maps, texture))
    predicted = moments_under(moments_of(texture), maps)
    scale = (seen[:, 0] + seen[:, 2])[:, None]
    assert np.abs((predicted - seen) / scale).max() < 1e-6


def test_affine_maps_come_apart():
    """A = S(s) R(θ) D(α, μ) gives its s, θ, α and μ back, and the same matrix."""
    rng = np.random.default_rng(1)
    given = rng.uniform(0.3, 3, N), rng.uniform(-3, 3, N), rng.uniform(1.02, 4, N), rng.uniform(-1.5, 1.5, N)
    parts = affine_parts(affine(*given))
    for one, other in zip(parts, given, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-6)


def test_the_shear_keeps_areas():
    """D(α, μ) has determinant 1 and stretches by α along μ: its lower right is α sin²μ + cos²μ / α."""
    shear = affine(np.array(1.0), np.array(0.0), np.array(2.0), np.array(0.7))
    np.testing.assert_allclose(np.linalg.det(shear), 1)
    axis = np.array([np.cos(0.7), np.sin(0.7)])
    np.testing.assert_allclose(shear @ axis, 2 * axis)


def test_equation_5_86():
    """T takes the image's moments to those on the surface, and its inverse back."""
    rng = np.random.default_rng(2)
    slant, tilt, maps = views(rng)
    surface = moments_of(waves(rng))
    image = moments_under(surface, maps)
    matrix = surface_from_image(slant, tilt)
    scale = (surface[:, 0] + surface[:, 2])[:, None]
    assert np.abs(np.einsum("nij,nj->ni", matrix, image) - surface).max() < 1e-6 * scale.max()
    np.testing.assert_allclose(
        matrix @ image_from_surface(slant, tilt), np.broadcast_to(np.eye(3), (N, 3, 3)), atol=1e-9
    )


def test_slant_and_tilt_from_exact_moments():
    """Slant, and one of four tilts, from exact moments to 1e-4 (Eqs. 5.89 to 5.93 with the errata)."""
    rng = np.random.default_rng(3)
    slant, tilt, maps = views(rng)
    surface = moments_of(waves(rng))
    found = candidates(canonical(moments_under(surface, maps)), canonical(surface))
    assert np.abs(found.slant - slant).max() < 1e-4
    assert np.abs(wrapped(found.tilts - tilt[:, None])).min(axis=1).max() < 1e-4


def test_an_isotropic_texture_has_two_candidates():
    """λ is 1: the four tilts are two, a half-turn apart, along the direction of the largest moment."""
    image = canonical(np.array([4.0, 0.0, 1.0]))
    found = candidates(image, canonical(np.array([1.0, 0.0, 1.0])))
    assert np.isclose(np.cos(found.slant), 0.5)
    np.testing.assert_allclose(np.abs(np.cos(found.tilts)), 1)


def test_the_nearest_candidate_says_how_clear_it_is():
    """Beside the right one the choice is clear; half-way between two it is not; without slant never."""
    found = normal_of(np.array(0.8), np.array([0.3, 0.3, 0.3 - np.pi, 0.3 - np.pi]))
    chosen, clarity = nearest(found, normal_of(np.array(0.7), np.array(0.4)))
    np.testing.assert_allclose(chosen, found[0])
    assert clarity > 0.8
    assert nearest(found, np.array([0.0, 0, -1]))[1] < 1e-6
    assert nearest(np.broadcast_to([0.0, 0, -1], (4, 3)), found[0])[1] == 0


def test_normals_face_the_camera():
    """(sin σ cos τ, sin σ sin τ, −cos σ), there and back."""
    rng = np.random.default_rng(4)
    slant, tilt, _ = views(rng)
    normals = normal_of(slant, tilt)
    assert (normals[:, 2] < 0).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    np.testing.assert_allclose(slant_and_tilt(normals), (slant, tilt), atol=1e-12)


def test_canonical_moments_are_eigenvalues():
    """M, m and θ of the matrix of moments, in the order of the errata."""
    moments = moments_of(waves(np.random.default_rng(5)))
    largest, smallest, orientation = canonical(moments)
    matrices = np.stack([moments[:, [0, 1]] * [1, 0.5], moments[:, [1, 2]] * [0.5, 1]], axis=1)
    values, vectors = np.linalg.eigh(matrices)
    np.testing.assert_allclose(np.stack([smallest, largest], axis=1), values, rtol=1e-7, atol=1e-12)
    along = np.abs(np.cos(orientation) * vectors[:, 0, 1] + np.sin(orientation) * vectors[:, 1, 1])
    np.testing.assert_allclose(along, 1)


def places(rng: np.random.Generator) -> tuple[Positions, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Image positions, nearness, slopes and normals of random surfaces in sight."""
    at = Positions(rng.uniform(-0.3, 0.3, N), rng.uniform(-0.3, 0.3, N))
    normals = normal_of(rng.uniform(0.02, 1.0, N), rng.uniform(-np.pi, np.pi, N))
    return at, rng.uniform(0.5, 2, N), *slopes_of_normal(at, normals), normals


def test_the_perspective_map_is_that_of_the_surface():
    """Lengths and normal of B are those of X = (U, V, 1)/w by differences."""
    at, w, a, b, normals = places(np.random.default_rng(6))
    np.testing.assert_allclose(normal_of_slopes(at, a, b), normals, atol=1e-12)
    h = 1e-6

    def point(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        near = w * (1 + a * (u - at.across) + b * (v - at.down))
        return np.stack([u, v, np.ones_like(u)], axis=-1) / near[:, None]

    across = (point(at.across + h, at.down) - point(at.across - h, at.down)) / (2 * h)
    down = (point(at.across, at.down + h) - point(at.across, at.down - h)) / (2 * h)
    edges = np.stack([across, down], axis=-1)
    matrix = to_surface(at, w, a, b)
    wanted = np.einsum("nki,nkj->nij", edges, edges)
    np.testing.assert_allclose(np.einsum("nki,nkj->nij", matrix, matrix), wanted, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(np.abs(np.einsum("nk,nki->ni", normals, edges)), 0, atol=1e-6)


def test_perspective_moments_return_to_the_surface():
    """Log moments on the surface are those that the image's were made of."""
    rng = np.random.default_rng(7)
    at, w, a, b, _ = places(rng)
    surface = moments_of(waves(rng))
    image = moments_under(surface, to_surface(at, w, a, b))
    np.testing.assert_allclose(surface_log_moments(image, at, w, a, b), log_moments(surface), atol=1e-6)


def test_candidates_under_perspective():
    """About each pixel's own ray the relations are exact: one of the four is the normal, to 1e-4."""
    rng = np.random.default_rng(8)
    at, w, a, b, normals = places(rng)
    surface = moments_of(waves(rng))
    image = moments_under(surface, to_surface(at, w, a, b))
    found = normal_candidates(image, at, w, canonical(surface))
    angles = np.arccos(np.clip(np.einsum("nki,ni->nk", found, normals), -1, 1)).min(axis=1)
    assert angles.max() < 1e-4
