"""PLY: an independent reader finds the points, normals and colours that were written."""

from __future__ import annotations

import struct

import numpy as np
import pytest

import visint.io
from visint.errors import OutputError


def unply(data):
    """(header lines, rows) of a binary little-endian PLY of floats and uchars."""
    head, body = data.split(b"end_header\n", 1)
    lines = head.decode("ascii").splitlines()
    types = [line.split()[1] for line in lines if line.startswith("property")]
    row = struct.Struct("<" + "".join({"float": "f", "uchar": "B"}[one] for one in types))
    return lines, [row.unpack_from(body, at) for at in range(0, len(body), row.size)]


def test_points_normals_and_colours_arrive(rng):
    """Row by row, in the order that the header says."""
    points, normals = (rng.normal(size=(4, 3)).astype(np.float32) for _ in range(2))
    colors = rng.integers(0, 256, (4, 3), dtype=np.uint8)
    lines, rows = unply(visint.io.encode_ply(points, normals=normals, colors=colors, unit="mm"))
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    assert "comment unit mm" in lines
    assert "element vertex 4" in lines
    names = [line.split()[2] for line in lines if line.startswith("property")]
    assert names == ["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"]
    np.testing.assert_array_equal(np.array(rows, np.float32), np.hstack([points, normals, colors]))


def test_maps_are_taken_as_they_are_and_unknown_points_left_out():
    """(H, W, 3) with holes; a known point whose normal is not known keeps zeros for it."""
    points = np.ones((2, 2, 3), np.float32)
    points[0, 1] = np.nan
    points[1, 0, 2] = np.inf
    normals = np.full((2, 2, 3), -1, np.float32)
    normals[1, 1] = np.nan
    lines, rows = unply(visint.io.encode_ply(points, normals=normals))
    assert "element vertex 2" in lines
    assert rows == [(1, 1, 1, -1, -1, -1), (1, 1, 1, 0, 0, 0)]


def test_a_cloud_without_a_point_is_a_file_still():
    """Nothing known: zero vertices."""
    lines, rows = unply(visint.io.encode_ply(np.full((3, 3, 3), np.nan, np.float32)))
    assert "element vertex 0" in lines
    assert rows == []


def test_a_unit_stays_in_its_comment():
    """A line feed in the unit cannot start a header line of its own."""
    lines, _ = unply(visint.io.encode_ply(np.ones((1, 3), np.float32), unit="mm\nelement face 9"))
    assert sum(line.startswith("element") for line in lines) == 1


@pytest.mark.parametrize(
    "arrays",
    [
        {"points": np.zeros((2, 3))},
        {"points": np.zeros((2, 2), np.float32)},
        {"points": np.zeros(3, np.float32)},
        {"points": np.zeros((2, 3), np.float32), "normals": np.zeros((1, 3), np.float32)},
        {"points": np.zeros((2, 3), np.float32), "colors": np.zeros((2, 3), np.float32)},
    ],
    ids=range(5),
)
def test_other_arrays_are_refused(arrays):
    """Another dtype or shape is no point cloud."""
    with pytest.raises(OutputError, match=r"VI603.*wants"):
        visint.io.encode_ply(**arrays)
