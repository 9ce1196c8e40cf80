"""Meshes against the surfaces they stand for."""

import importlib.util

import numpy as np
import pytest

import visint
from visint_lab.rays.finish import Plain
from visint_lab.rays.meshes import mesh_of, read_mesh
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Box, HeightMap, Sphere
from visint_lab.render.rendering import render

RIG = Rig.parallel((96, 96), 180.0, 2.0)
needs_trimesh = pytest.mark.skipif(not importlib.util.find_spec("trimesh"), reason="trimesh is not installed")
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))])


def seen(shape, rotation=None):
    thing = Thing(shape, Plain(0.8), (0.0, 0.0, 40.0), rotation or turned(0.4, 0.6))
    return render(Scene("mesh", (thing,), Lamp("distant", (0.0, 0.0, -1.0)), RIG), samples=1).truth


def ball(rings, radius):
    """A sphere of quadrilateral rings cut into triangles, counter-clockwise from outside."""
    v, u = np.meshgrid(
        np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1), indexing="ij"
    )
    points = radius * np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], -1).reshape(-1, 3)
    index = np.arange(points.shape[0]).reshape(v.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    return points, triangles


def test_a_cube_of_triangles_is_the_box():
    """Depth, normals, creases and outline are those of the box of the same size."""
    mesh, box = seen(mesh_of(6 * CUBE, TRIANGLES)), seen(Box(6, 6, 6))
    np.testing.assert_array_equal(mesh.foreground, box.foreground)
    np.testing.assert_allclose(mesh.depth, box.depth, atol=1e-5)
    np.testing.assert_allclose(mesh.normals, box.normals, atol=1e-5)
    np.testing.assert_array_equal(mesh.edges, box.edges)
    assert len(np.unique(mesh.regions)) == len(np.unique(box.regions)) == 4


def test_a_ball_of_triangles_is_nearly_the_ball():
    """Fine triangles with smooth normals: depth to 1 %, normals to a degree, an outline of limb."""
    mesh, true = seen(mesh_of(*ball(64, 8.0))), seen(Sphere(8.0))
    both = mesh.foreground & true.foreground
    assert (mesh.foreground ^ true.foreground).sum() < 30
    inner = both & (true.normals[..., 2] < -0.3)
    assert np.abs(mesh.depth - true.depth)[inner].max() < 0.08
    cosine = (mesh.normals * true.normals).sum(-1)[inner]
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 1.0
    counts = np.bincount(mesh.edges.ravel(), minlength=7)
    assert counts[1] > 150
    assert counts[2:].sum() <= 3  # at the very limb a flat triangle may shade a smooth normal


def test_a_height_map_is_the_paraboloid_it_samples():
    """A parabola's B-spline of its own samples is the parabola but for a known shift: exact normals."""
    grid = (np.arange(41) - 20) * 0.5
    x, y = np.meshgrid(grid, grid)
    heights = 5 - (x**2 + y**2) / 40
    truth = seen(HeightMap(heights, 0.5), turned())
    u = np.arange(96) - 47.5
    rays = np.stack([*np.meshgrid(u / 180, u / 180), np.ones((96, 96))], -1)
    points = truth.depth[..., None] * rays - np.array([2.0, 0.0, 40.0])
    inner = truth.foreground
    lift = 2 * (0.5**2 / 3) / 40  # the spline smooths: its variance is a third of a cell squared, each way
    expected = (points[..., 0] ** 2 + points[..., 1] ** 2) / 40 - 5 + lift
    assert inner.sum() > 3000
    np.testing.assert_allclose(points[..., 2][inner], expected[inner], atol=1e-4)
    slope = np.stack([points[..., 0] / 20, points[..., 1] / 20, -np.ones((96, 96))], -1)
    normal = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    np.testing.assert_allclose(truth.normals[inner], normal[inner], atol=1e-4)


@needs_trimesh
@pytest.mark.parametrize("suffix", ["ply", "obj"])
def test_files_are_read_centred_scaled_and_turned_upright(suffix, tmp_path):
    """A cube set off its centre fills the sphere asked for; what was up is up in the image."""
    import trimesh

    tall = CUBE * np.array([1.0, 2.0, 1.0]) + 5
    tall[CUBE[:, 1] > 0] += np.array([0.5, 0.0, 0.0])  # its top leans to +x
    path = tmp_path / f"cube.{suffix}"
    trimesh.Trimesh(tall, TRIANGLES, process=False).export(path)
    mesh = read_mesh(path, radius=9.0)
    assert np.linalg.norm(mesh.corners, axis=-1).max() == pytest.approx(9.0)
    top = mesh.corners[mesh.corners[..., 1] < 0]  # y points down here
    assert top[:, 0].mean() > 0.5
    assert len(np.unique(mesh.patches)) == 6


@needs_trimesh
@pytest.mark.parametrize("data", [b"", b"ply\nformat ascii 1.0\n", b"\x00" * 50])
def test_a_broken_mesh_is_one_line(data, tmp_path):
    """An InputError names the file."""
    path = tmp_path / "bad.ply"
    path.write_bytes(data)
    with pytest.raises(visint.InputError, match=r"bad\.ply"):
        read_mesh(path)


def test_another_format_is_refused(tmp_path):
    """What is no mesh file is refused by its name, with the formats that are read."""
    with pytest.raises(visint.InputError, match=r"\.ply"):
        read_mesh(tmp_path / "scene.blend")
