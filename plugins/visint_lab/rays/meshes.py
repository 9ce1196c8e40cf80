"""Triangle meshes from PLY, OBJ and STL files.

The files are read by trimesh (an optional dependency, extra ``meshes``): it needs only numpy, is well kept and
knows the formats' many dialects, which are not what this project is for.
"""

from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visint.errors import InputError, UsageError
from visint_lab.rays.shapes import Mesh

__all__ = ["mesh_of", "read_mesh"]

CREASE = math.radians(40.0)
FORMATS = (".ply", ".obj", ".stl", ".off")


def read_mesh(path: str | Path, radius: float = 9.0, upright: bool = True) -> Mesh:
    """The surface in a mesh file, centred and scaled into a sphere of ``radius``.

    Parameters
    ----------
    upright
        The file's y axis points up and its front towards +z, as in most: turned to point down and away from
        the camera. False keeps the file's axes.

    Raises
    ------
    UsageError
        If trimesh is not installed.
    InputError
        If the file is missing, broken, of another format or holds no triangles.
    """
    from visint.io import read_bytes

    path = Path(path)
    if path.suffix.lower() not in FORMATS:
        raise InputError.of(
            "VI305", "is no mesh file that is read here", where=path.name, choices=", ".join(FORMATS)
        )
    data = BytesIO(read_bytes(path))
    try:
        loaded = _trimesh().load(data, file_type=path.suffix.lower()[1:], force="mesh")
        vertices, triangles = np.asarray(loaded.vertices, dtype=np.float64), np.asarray(loaded.faces)
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, NotImplementedError) as error:
        raise InputError.of("VI302", f"is broken: {error}", where=path.name) from None
    if not len(triangles) or not np.isfinite(vertices).all():
        raise InputError.of("VI302", "holds no triangles, or corners that are no numbers", where=path.name)
    return mesh_of(_placed(vertices, radius, upright), triangles)


def _trimesh() -> Any:
    import importlib

    try:
        return importlib.import_module("trimesh")
    except ImportError:
        raise UsageError.of("VI701", "mesh files want trimesh", write="pip install 'visint[meshes]'") from None


def _placed(vertices: NDArray[np.float64], radius: float, upright: bool) -> NDArray[np.float64]:
    centred = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    scaled: NDArray[np.float64] = centred * (radius / np.linalg.norm(centred, axis=1).max())
    return scaled * np.array([1.0, -1.0, -1.0]) if upright else scaled


def mesh_of(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> Mesh:
    """A mesh with normals that are smooth except across creases of more than 40°.

    ``vertices`` (N, 3), ``triangles`` (T, 3) indices, counter-clockwise seen from outside. Triangles without
    area are left out.
    """
    corners = vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(areas, axis=1)
    kept = size > 1e-12 * size.max()
    triangles, corners, areas = triangles[kept], corners[kept], areas[kept]
    welded = _welded(vertices)[triangles]
    patches = _smooth_patches(welded, areas)
    return Mesh(corners, _corner_normals(welded, areas, patches), patches)


def _welded(vertices: NDArray[np.float64]) -> NDArray[np.int64]:
    """Equal numbers for vertices at one place: files repeat them along seams."""
    step = 1e-7 * max(float(np.ptp(vertices)), 1e-30)
    _, same = np.unique(np.round(vertices / step).astype(np.int64), axis=0, return_inverse=True)
    return np.asarray(same.reshape(-1), dtype=np.int64)


def _smooth_patches(triangles: NDArray[np.int64], areas: NDArray[np.float64]) -> NDArray[np.int64]:
    """Triangles joined over edges that bend by less than a crease."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    first, second = order[:-1][same] // 3, order[1:][same] // 3
    unit = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    gentle = (unit[first] * unit[second]).sum(axis=1) > math.cos(CREASE)
    links = (np.ones(gentle.sum()), (first[gentle], second[gentle]))
    _, patches = connected_components(coo_matrix(links, shape=(len(triangles),) * 2), directed=False)
    return np.asarray(patches, dtype=np.int64)


def _corner_normals(
    triangles: NDArray[np.int64], areas: NDArray[np.float64], patches: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(T, 3, 3): at each corner the mean normal of the patch's triangles there, weighted by area."""
    keys = triangles + patches[:, None] * (int(triangles.max()) + 1)
    _, place = np.unique(keys, return_inverse=True)
    total = np.zeros((place.max() + 1, 3))
    np.add.at(total, place.reshape(-1), np.repeat(areas, 3, axis=0))
    normals: NDArray[np.float64] = total[place].reshape(*triangles.shape, 3)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
    return normals
