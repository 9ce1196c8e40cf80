"""Every type of array in every format that is written: exactly what went in by another library, or refused."""

from __future__ import annotations

import io

import cv2
import numpy as np
import plyfile
import pytest

import visint.io
from visint.errors import OutputError

trimesh = pytest.importorskip("trimesh")

SHAPES = [(4, 5), (4, 5, 3), (4, 5, 2), (4, 5, 4), (7,), (7, 3), (), (0, 5), (2, 3, 4, 3)]
NUMBERS = ["?", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f2", "f4", "f8", "g", "c8", "c16"]
STRANGERS = {
    "objects": np.array([[None, 1]], object),
    "texts": np.array([["a", "b"]]),
    "bytes": np.array([[b"a", b"b"]]),
    "times": np.array([["2020-01-01"]], "M8[D]"),
    "spans": np.array([[1]], "m8[s]"),
    "records": np.zeros((2, 2), [("a", "f4")]),
    "voids": np.zeros((2, 2), "V3"),
}


def png(data):
    read = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    return read[..., ::-1] if read.ndim == 3 else read


def pfm(data):
    """As Middlebury's page describes it."""
    head, size, scale, body = data.split(b"\n", 3)
    columns, rows = map(int, size.split())
    values = np.frombuffer(body, "<f4" if float(scale) < 0 else ">f4")
    return values.reshape((rows, columns, 3) if head == b"PF" else (rows, columns))[::-1]


def kitti(data):
    """The development kit: disparity = sample / 256, 0 is invalid."""
    return png(data).astype(np.float64) / 256


def ply(data):
    vertices = plyfile.PlyData.read(io.BytesIO(data))["vertex"]
    return np.column_stack([vertices[name] for name in "xyz"])


def glb(data):
    scene = trimesh.load(io.BytesIO(data), file_type="glb", process=False)
    return next(iter(scene.geometry.values())).vertices.astype(np.float32)


def encode_glb(array):
    return visint.io.encode_glb(array, np.array([[0, 1, 2]], np.int32))


PNG_TYPES, PNG_SHAPES = {"u1", "u2"}, {(4, 5), (7, 3), (4, 5, 3)}
FORMATS = {
    # encode, an independent reader, and whether (dtype, shape) is taken
    "PNG": (
        visint.io.encode_png,
        png,
        lambda t, s: s in PNG_SHAPES if t in PNG_TYPES else len(s) == 2 and 0 not in s and t in ("?", "i4"),
    ),
    "PFM": (visint.io.encode_pfm, pfm, lambda t, s: t == "f4" and s in PNG_SHAPES),
    "KITTI": (visint.io.encode_kitti, kitti, lambda t, s: t == "f4" and len(s) == 2 and 0 not in s),
    "npy": (visint.io.encode_npy, lambda d: np.load(io.BytesIO(d), allow_pickle=False), lambda t, s: True),
    "npz": (
        lambda a: visint.io.encode_npz({"a": a}),
        lambda d: np.load(io.BytesIO(d), allow_pickle=False)["a"],
        lambda t, s: True,
    ),
    "PLY": (visint.io.encode_ply, ply, lambda t, s: t == "f4" and len(s) > 1 and s[-1] == 3),
    "GLB": (encode_glb, glb, lambda t, s: t == "f4" and s == (7, 3)),
}


def filled(dtype, shape):
    """Numbers that the type holds and narrower ones do not."""
    rng = np.random.default_rng(5)
    dtype = np.dtype(dtype)
    if dtype.kind in "iu":
        low, high = (0, 60_000) if dtype == np.int32 else (np.iinfo(dtype).min, np.iinfo(dtype).max)
        return rng.integers(low, high, shape, dtype, endpoint=True)
    return (rng.random(shape) * 200).astype(dtype) if dtype.kind != "b" else rng.random(shape) > 0.5


def expected(name, array):
    """What the format's reader must find."""
    if name == "PNG" and array.dtype == bool:
        return array.astype(np.uint8) * 255
    if name == "KITTI":
        return np.rint(array * 256) / 256
    return array.reshape(-1, 3) if name == "PLY" else array


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("dtype", NUMBERS)
@pytest.mark.parametrize("name", FORMATS)
def test_exact_or_refused(name, dtype, shape):
    """The whole table: format by dtype by shape."""
    encode, decode, takes = FORMATS[name]
    array = filled(dtype, shape)
    if takes(dtype, shape):
        read = decode(encode(array))
        wanted = expected(name, array)
        assert read.dtype == wanted.dtype or (name, dtype) in {("PNG", "i4"), ("KITTI", "f4")}
        np.testing.assert_array_equal(read, wanted)
    else:
        with pytest.raises(OutputError, match="VI603"):
            encode(array)


@pytest.mark.parametrize("stranger", STRANGERS)
@pytest.mark.parametrize("name", FORMATS)
def test_what_is_no_number_is_refused(name, stranger):
    """Objects, texts, times, records: no format takes them, and none pickles."""
    with pytest.raises(OutputError, match="VI603"):
        FORMATS[name][0](STRANGERS[stranger])


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("layout", ["C", "F", "strided", "read-only"])
@pytest.mark.parametrize("name", ["PNG", "PFM", "npy", "npz", "PLY"])
def test_layout_and_byte_order_do_not_matter(name, layout, order):
    """The same values from any view of them; another byte order is exact in npy, else refused."""
    encode, decode, _ = FORMATS[name]
    plain = filled("u2" if name == "PNG" else "f4", (4, 5, 3))
    array = plain.astype(plain.dtype.newbyteorder(order))
    if layout == "F":
        array = np.asfortranarray(array)
    elif layout == "strided":
        array = np.repeat(np.repeat(array, 2, 0), 2, 1)[::2, ::2]
    elif layout == "read-only":
        array.flags.writeable = False
    if order == ">" and name not in ("npy", "npz"):
        with pytest.raises(OutputError, match="VI603"):
            encode(array)
    else:
        np.testing.assert_array_equal(decode(encode(array)), expected(name, plain))


def test_unknown_is_what_each_format_calls_it():
    """inf in PFM, 0 in KITTI PNG, left out of PLY, NaN in npy and npz."""
    values = np.array([[1, np.nan], [np.inf, 2.5]], np.float32)
    np.testing.assert_array_equal(pfm(visint.io.encode_pfm(values)), [[1, np.inf], [np.inf, 2.5]])
    np.testing.assert_array_equal(kitti(visint.io.encode_kitti(values)), [[1, 0], [0, 2.5]])
    np.testing.assert_array_equal(np.load(io.BytesIO(visint.io.encode_npy(values))), values)
    points = np.dstack([values] * 3)
    np.testing.assert_array_equal(ply(visint.io.encode_ply(points)), [[1, 1, 1], [2.5, 2.5, 2.5]])


def test_opencv_reads_the_same_pfm():
    """To the last bit, grey and colour (blue first, as OpenCV has it)."""
    for shape in ((4, 5), (4, 5, 3)):
        values = filled("f4", shape)
        read = cv2.imdecode(np.frombuffer(visint.io.encode_pfm(values), np.uint8), cv2.IMREAD_UNCHANGED)
        if read is None:
            pytest.skip("this OpenCV decodes no PFM from memory")
        np.testing.assert_array_equal(read[..., ::-1] if read.ndim == 3 else read, values)


def test_plyfile_and_trimesh_read_the_same_cloud():
    """Positions and normals to the last bit, colours as they are, the unit as a comment."""
    rng = np.random.default_rng(1)
    points, normals = (rng.normal(size=(40, 3)).astype(np.float32) for _ in range(2))
    colors = rng.integers(0, 256, (40, 3), dtype=np.uint8)
    data = visint.io.encode_ply(points, normals=normals, colors=colors, unit="mm")
    read = plyfile.PlyData.read(io.BytesIO(data))
    vertices = read["vertex"]
    for names, wanted in (
        (("x", "y", "z"), points),
        (("nx", "ny", "nz"), normals),
        (("red", "green", "blue"), colors),
    ):
        np.testing.assert_array_equal(np.column_stack([vertices[name] for name in names]), wanted)
    assert "unit mm" in read.comments
    cloud = trimesh.load(io.BytesIO(data), file_type="ply", process=False)
    np.testing.assert_array_equal(cloud.vertices.astype(np.float32), points)
    np.testing.assert_array_equal(cloud.colors[:, :3], colors)


def test_units_stand_beside_their_arrays(put):
    """numpy reads them without pickling; visint's own reader passes them over."""
    depth = filled("f4", (4, 5))
    data = visint.io.encode_npz({"a.depth": depth, "b": depth}, {"a.depth": "mm"})
    with np.load(io.BytesIO(data), allow_pickle=False) as read:
        assert read["a.depth.unit"].item() == "mm"
        assert set(read) == {"a.depth", "a.depth.unit", "b"}
    assert set(visint.io.read_npz(put(data))) == {"a.depth", "b"}
    one = put(visint.io.encode_npz({"normals": np.zeros((1, 1), np.float32)}, {"normals": "µm"}))
    assert visint.io.read(one, "Depth").shape == (1, 1)
