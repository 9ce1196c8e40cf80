"""GLB: trimesh finds the triangles, normals and colours that were written, turned and in metres."""

from __future__ import annotations

import io
import json
import struct

import numpy as np
import pytest

import visint.io
from visint.errors import OutputError

trimesh = pytest.importorskip("trimesh")


@pytest.fixture
def mesh(rng):
    points = rng.normal(size=(6, 3)).astype(np.float32)
    normals = rng.normal(size=(6, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    colors = rng.integers(0, 256, (6, 3), dtype=np.uint8)
    faces = np.array([[0, 1, 2], [2, 1, 3], [3, 4, 5]], np.int32)
    return points, faces, normals, colors


def parts(data):
    """The JSON and the binary chunk, read by the container's definition."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size = struct.unpack_from("<I4s", data, 12)[0]
    told = json.loads(data[20 : 20 + size])
    return told, data[28 + size :]


def test_trimesh_reads_the_same_mesh(mesh):
    """Points to the last bit before the node's matrix; faces and normals as they are."""
    points, faces, normals, colors = mesh
    data = visint.io.encode_glb(points, faces, normals=normals, colors=colors, unit="mm")
    scene = trimesh.load(io.BytesIO(data), file_type="glb", process=False)
    (name,) = scene.geometry
    read = scene.geometry[name]
    np.testing.assert_array_equal(read.vertices.astype(np.float32), points)
    np.testing.assert_array_equal(read.faces, faces)
    np.testing.assert_allclose(read.vertex_normals, normals, atol=1e-6)
    matrix, _ = scene.graph.get(scene.graph.nodes_geometry[0])
    np.testing.assert_allclose(matrix, np.diag([1e-3, -1e-3, -1e-3, 1]))


def test_colours_are_linear_with_16_bits(mesh):
    """By glTF's definition of COLOR_0; each of the 256 values stays apart from the others."""
    points, faces, _, colors = mesh
    told, body = parts(visint.io.encode_glb(points, faces, colors=colors))
    index = told["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]
    accessor = told["accessors"][index]
    view = told["bufferViews"][accessor["bufferView"]]
    assert (accessor["componentType"], accessor["normalized"], accessor["type"]) == (5123, True, "VEC4")
    stored = np.frombuffer(body, "<u2", 6 * 4, view["byteOffset"]).reshape(6, 4)
    np.testing.assert_array_equal(visint.io.srgb_from_linear(stored[:, :3] / 65535), colors)
    assert (stored[:, 3] == 65535).all()


def test_the_container_is_as_defined(mesh):
    """Chunks and views begin at multiples of four; positions tell their bounds; all bytes are accounted for."""
    points, faces, normals, colors = mesh
    told, body = parts(visint.io.encode_glb(points, faces, normals=normals, colors=colors, unit="m"))
    assert all(view["byteOffset"] % 4 == 0 for view in told["bufferViews"])
    assert told["buffers"][0]["byteLength"] == sum(view["byteLength"] for view in told["bufferViews"])
    assert len(body) % 4 == 0
    np.testing.assert_array_equal(told["accessors"][0]["min"], points.min(0).astype(float))
    np.testing.assert_array_equal(told["accessors"][0]["max"], points.max(0).astype(float))
    assert told["nodes"][0]["matrix"][0] == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"points": np.zeros((6, 3))}, "wants float32"),
        ({"points": np.full((6, 3), np.nan, np.float32)}, "not finite"),
        ({"faces": np.zeros((0, 3), np.int32)}, "wants int32"),
        ({"faces": np.array([[0, 1, 6]], np.int32)}, "points that there are not"),
        ({"faces": np.array([[0, 1, -1]], np.int32)}, "points that there are not"),
        ({"faces": np.array([[0.0, 1, 2]])}, "wants int32"),
        ({"colors": np.zeros((6, 3), np.float32)}, "wants uint8"),
        ({"normals": np.zeros((5, 3), np.float32)}, r"wants float32 \(6, 3\)"),
    ],
)
def test_other_arrays_are_refused(mesh, change, words):
    """Another dtype or shape is no mesh."""
    points, faces, normals, colors = mesh
    given = {"points": points, "faces": faces, "normals": normals, "colors": colors, **change}
    with pytest.raises(OutputError, match=f"VI603.*{words}"):
        visint.io.encode_glb(given.pop("points"), given.pop("faces"), **given)
