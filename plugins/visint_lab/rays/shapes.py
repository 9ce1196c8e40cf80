"""Shapes: the six primitives of the dissertation, planes, height maps and meshes.

Each stands in a frame of its own, centred at the origin, in the unit of the scene's baseline. Frames are
right-handed like the camera's: x right, y down, z forward, so a shape's face towards −z is the near one.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visint.errors import UsageError

__all__ = ["Box", "Cylinder", "Ellipsoid", "HeightMap", "Hyperboloid", "Mesh", "Paraboloid", "Plane", "Shape"]
__all__ += ["Sphere", "Torus"]

QUADRIC, BOX, TORUS, HEIGHTS, MESH = 0, 1, 2, 3, 4
EVERYWHERE = 1e29


class Shape(ABC):
    """A surface. ``code`` tells the ray caster which kind it is."""

    code: int = QUADRIC

    @abstractmethod
    def numbers(self) -> tuple[float, ...]:
        """What the ray caster knows of the shape, at most ten numbers."""

    @property
    @abstractmethod
    def radius(self) -> float:
        """Of a sphere around the origin that holds the whole shape; 0 if there is none."""


def _quadric(form: tuple[float, ...], low: float, high: float, girth: float = 0.0) -> tuple[float, ...]:
    """{a x² + b y² + c z² + d z + e ≤ 0, low ≤ z ≤ high}, closed by caps where low or high cut it."""
    return (*form, low, high, 1.0, girth, 0.0)


@dataclass(frozen=True)
class Plane(Shape):
    """The unbounded plane z = 0."""

    def numbers(self) -> tuple[float, ...]:
        return (0.0, 0.0, 0.0, 1.0, 0.0, -EVERYWHERE, EVERYWHERE, 0.0, 0.0, 0.0)

    @property
    def radius(self) -> float:
        return 0.0


@dataclass(frozen=True)
class Ellipsoid(Shape):
    """x²/a² + y²/b² + z²/c² = 1."""

    a: float
    b: float
    c: float

    def numbers(self) -> tuple[float, ...]:
        inverse = (1 / self.a**2, 1 / self.b**2, 1 / self.c**2)
        return (*inverse, 0.0, -1.0, -EVERYWHERE, EVERYWHERE, 0.0, self.c, 1.0)

    @property
    def radius(self) -> float:
        return max(self.a, self.b, self.c)


class Sphere(Ellipsoid):
    """x² + y² + z² = r²."""

    def __init__(self, r: float) -> None:
        super().__init__(r, r, r)


@dataclass(frozen=True)
class Cylinder(Shape):
    """x² + y² ≤ r², |z| ≤ h, with its two caps."""

    r: float
    h: float

    def numbers(self) -> tuple[float, ...]:
        return _quadric((1.0, 1.0, 0.0, 0.0, -(self.r**2)), -self.h, self.h, self.r)

    @property
    def radius(self) -> float:
        return math.hypot(self.r, self.h)


@dataclass(frozen=True)
class Paraboloid(Shape):
    """x² + y² ≤ r² (z + h)/(2h), |z| ≤ h: a bowl of rim radius r, its apex at z = −h, closed at z = h."""

    r: float
    h: float

    def numbers(self) -> tuple[float, ...]:
        slope = self.r**2 / (2 * self.h)
        return _quadric((1.0, 1.0, 0.0, -slope, -slope * self.h), -self.h, self.h, self.r)

    @property
    def radius(self) -> float:
        return math.hypot(self.r, self.h)


@dataclass(frozen=True)
class Hyperboloid(Shape):
    """x² + y² ≤ a² (1 + z²/c²), |z| ≤ h: of one sheet, its waist of radius a, with its two caps."""

    a: float
    c: float
    h: float

    def numbers(self) -> tuple[float, ...]:
        return _quadric((1.0, 1.0, -((self.a / self.c) ** 2), 0.0, -(self.a**2)), -self.h, self.h, self.a)

    @property
    def radius(self) -> float:
        return math.hypot(self.a * math.hypot(1.0, self.h / self.c), self.h)


@dataclass(frozen=True)
class Box(Shape):
    """|x| ≤ a, |y| ≤ b, |z| ≤ c: the parallelepiped."""

    a: float
    b: float
    c: float
    code = BOX

    def numbers(self) -> tuple[float, ...]:
        return (self.a, self.b, self.c)

    @property
    def radius(self) -> float:
        return math.hypot(self.a, self.b, self.c)


@dataclass(frozen=True)
class Torus(Shape):
    """A tube of radius r around a ring of radius R about the z axis."""

    R: float
    r: float
    code = TORUS

    def numbers(self) -> tuple[float, ...]:
        return (self.R, self.r)

    @property
    def radius(self) -> float:
        return self.R + self.r


@dataclass(frozen=True, eq=False)
class HeightMap(Shape):
    """z = −heights[row, column] over a grid of ``pitch``, as a cubic B-spline (smooth normals).

    Parameters
    ----------
    heights
        (H, W), towards the camera, in scene units; NaN where there is no surface. The spline takes them as its
        control points, so it smooths them by about half a cell.
    pitch
        Distance of neighbouring samples.
    """

    heights: NDArray[np.float64]
    pitch: float
    code = HEIGHTS

    def __post_init__(self) -> None:
        if self.heights.ndim != 2 or min(self.heights.shape) < 4 or not np.isfinite(self.heights).any():
            raise UsageError.of(
                "VI305", f"a height map wants (H, W) numbers, at least 4×4; this is {self.heights.shape}"
            )

    def numbers(self) -> tuple[float, ...]:
        rows, columns = self.heights.shape
        low, high = -float(np.nanmax(self.heights)), -float(np.nanmin(self.heights))
        margin = 1e-6 + 1e-3 * (high - low)
        return (0.0, float(rows), float(columns), self.pitch, low - margin, high + margin)

    @property
    def radius(self) -> float:
        rows, columns = self.heights.shape
        return math.hypot(rows * self.pitch / 2, columns * self.pitch / 2, float(np.nanmax(abs(self.heights))))


@dataclass(frozen=True, eq=False)
class Mesh(Shape):
    """Triangles with a normal at every corner.

    A mesh casts no shadow on itself over less than a tenth of its radius: flat triangles would shade each other
    where their smooth normals still face the light.

    Parameters
    ----------
    corners
        float64 (T, 3, 3): the three corner points of each triangle.
    normals
        float64 (T, 3, 3): unit normals there, outward; interpolated over the triangle.
    patches
        int (T,): triangles that meet in a crease belong to different patches.
    """

    corners: NDArray[np.float64]
    normals: NDArray[np.float64]
    patches: NDArray[np.int64]
    code = MESH

    def numbers(self) -> tuple[float, ...]:
        return (0.0,)

    @property
    def radius(self) -> float:
        return float(np.linalg.norm(self.corners, axis=-1).max())
