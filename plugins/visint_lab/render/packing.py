"""A scene as the arrays that the ray caster reads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from visint_lab.rays.finish import Finish, Picture, Split
from visint_lab.rays.scene import Scene, Thing
from visint_lab.rays.shapes import HeightMap, Mesh
from visint_lab.rays.tree import box_tree

__all__ = ["Packed", "pack"]

WIDTH, PARAMS = 24, 14


class Packed(NamedTuple):
    """One row a thing, a finish, a picture, a tree node, a triangle; see ``_kernels`` for the columns."""

    things: NDArray[np.float64]
    kinds: NDArray[np.int64]
    materials: NDArray[np.float64]
    finishes: NDArray[np.int64]
    pictures: NDArray[np.int64]
    texels: NDArray[np.float64]
    heights: NDArray[np.float64]
    bounds: NDArray[np.float64]
    links: NDArray[np.int64]
    triangles: NDArray[np.float64]
    corners: NDArray[np.float64]
    patches: NDArray[np.int64]


def pack(scene: Scene) -> Packed:
    """The arrays of ``scene``, which must hold at least one thing."""
    finishes = _Finishes()
    heights = _Flat()
    meshes = _Meshes()
    things = np.zeros((len(scene.things), WIDTH))
    kinds = np.zeros((len(scene.things), 2), dtype=np.int64)
    for row, kind, thing in zip(things, kinds, scene.things, strict=True):
        _place(row, thing)
        kind[:] = thing.shape.code, finishes.add(thing.finish)
        if isinstance(thing.shape, HeightMap):
            row[PARAMS] = heights.add(thing.shape.heights * -1.0)
        if isinstance(thing.shape, Mesh):
            row[PARAMS] = meshes.add(thing.shape)
    return Packed._make((things, kinds, *finishes.tables(), heights.array(), *meshes.tables()))


def _place(row: NDArray[np.float64], thing: Thing) -> None:
    row[:9] = np.asarray(thing.rotation, dtype=np.float64).T.ravel()
    row[9:12] = thing.position
    row[13] = thing.shape.radius
    numbers = thing.shape.numbers()
    row[PARAMS : PARAMS + len(numbers)] = numbers


class _Flat:
    """Arrays laid one behind the other."""

    def __init__(self) -> None:
        self.parts: list[NDArray[np.float64]] = []
        self.size = 0

    def add(self, part: NDArray[np.float64]) -> int:
        """Where ``part`` begins."""
        begin = self.size
        self.parts.append(np.asarray(part, dtype=np.float64).ravel())
        self.size += self.parts[-1].size
        return begin

    def array(self) -> NDArray[np.float64]:
        return np.concatenate(self.parts) if self.parts else np.zeros(1)


class _Finishes:
    """Finishes in a table, those inside a split by their place in it."""

    def __init__(self) -> None:
        self.numbers: list[list[float]] = []
        self.choices: list[list[int]] = []
        self.pictures: list[tuple[int, int, int]] = []
        self.texels = _Flat()

    def add(self, finish: Finish) -> int:
        """The row of ``finish``."""
        row = len(self.numbers)
        numbers = finish.numbers()
        self.numbers.append([*numbers, *(0.0,) * (7 - len(numbers)), finish.gloss, finish.shininess])
        self.choices.append([finish.code, *finish.choices()])
        if isinstance(finish, Picture):
            self.choices[row][1] = len(self.pictures)
            self.pictures.append((self.texels.add(finish.image), *finish.image.shape))
        if isinstance(finish, Split):
            self.choices[row][1:3] = self.add(finish.near), self.add(finish.beyond)
        return row

    def tables(self) -> tuple[NDArray[Any], ...]:
        pictures = np.array(self.pictures or [(0, 2, 2)], dtype=np.int64)
        return np.array(self.numbers), np.array(self.choices, dtype=np.int64), pictures, self.texels.array()


class _Meshes:
    """Triangles of all meshes behind each other, one tree each."""

    def __init__(self) -> None:
        self.parts: list[tuple[NDArray[Any], ...]] = []
        self.nodes = self.triangles = 0

    def add(self, mesh: Mesh) -> int:
        """The root of the mesh's tree."""
        root = self.nodes
        tree = box_tree(mesh.corners)
        leaf = tree.links[:, 1] < 0
        links = tree.links + np.where(leaf[:, None], (self.triangles, 0), self.nodes)
        corners = mesh.corners[tree.order]
        edges = np.concatenate([corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], 1)
        normals = mesh.normals[tree.order].reshape(-1, 9)
        self.parts.append((tree.bounds, links, edges, normals, mesh.patches[tree.order].astype(np.int64)))
        self.nodes += len(links)
        self.triangles += len(corners)
        return root

    def tables(self) -> Sequence[NDArray[Any]]:
        if self.parts:
            return [np.ascontiguousarray(np.concatenate(part)) for part in zip(*self.parts, strict=True)]
        empty = np.zeros((1, 9))
        return [np.zeros((1, 6)), np.zeros((1, 2), np.int64), empty, empty.copy(), np.zeros(1, np.int64)]
