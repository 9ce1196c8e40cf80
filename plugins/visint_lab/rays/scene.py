"""Scenes: things with a shape, a finish and a place, a lamp, and a pair of cameras."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from visint_lab.rays.finish import Finish, Plain
from visint_lab.rays.rig import UPRIGHT, Matrix, Rig, Vector
from visint_lab.rays.shapes import Shape

__all__ = ["Grain", "Lamp", "Scene", "Thing", "turned"]


def turned(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Matrix:
    """The rotation by angles (radians) about x, then y, then z; it turns a shape's vectors into the scene."""
    from scipy.spatial.transform import Rotation

    return tuple(map(tuple, Rotation.from_euler("xyz", (x, y, z)).as_matrix().tolist()))  # type: ignore[return-value]


@dataclass(frozen=True)
class Thing:
    """A shape with a finish, turned by ``rotation`` and set at ``position``."""

    shape: Shape
    finish: Finish = field(default_factory=Plain)
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Matrix = UPRIGHT


@dataclass(frozen=True)
class Lamp:
    """A light of strength 1, in the scene's frame, that does not fade with distance.

    Parameters
    ----------
    place
        ``point``, or ``distant``: then ``vector`` points from the surface to the light.
    ambient
        Brightness, in parts of the albedo, that everything gets from everywhere.
    shadows
        Whether things cast shadows.
    """

    place: Literal["point", "distant"]
    vector: Vector
    ambient: float = 0.0
    shadows: bool = True

    def numbers(self, background: float) -> NDArray[np.float64]:
        """(7,) for the ray caster."""
        vector = np.asarray(self.vector, dtype=np.float64)
        if self.place == "distant":
            vector = vector / np.linalg.norm(vector)
        flags = (float(self.place == "point"), self.ambient, background, float(self.shadows))
        return np.array([*vector, *flags])


@dataclass(frozen=True)
class Grain:
    """Image noise: I·(1 + multiplicative·n₁) + additive·n₂ with unit normal n₁, n₂, clipped to [0, 1].

    Both are in parts of full brightness: 2 % noise is ``additive=0.02``.
    """

    additive: float = 0.0
    multiplicative: float = 0.0


@dataclass(frozen=True)
class Scene:
    """All that is needed to render a pair.

    Parameters
    ----------
    background
        Brightness where a ray meets nothing.
    """

    name: str
    things: tuple[Thing, ...]
    lamp: Lamp
    rig: Rig
    background: float = 0.0
    grain: Grain = Grain()
