"""Finishes: how a surface reflects, and its albedo from place to place."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Checker", "Finish", "Noise", "Picture", "Plain", "Split"]

PLAIN, CHECKER, NOISE, PICTURE, SPLIT = 0, 1, 2, 3, 4
Mapping = Literal["solid", "surface"]


@dataclass(frozen=True, kw_only=True)
class Finish:
    """Lambertian, and a Phong lobe on top where ``gloss`` is positive.

    Brightness is ``albedo·(ambient + n·l) + gloss·(r·v)**shininess``, r being l mirrored at n.

    Parameters
    ----------
    gloss
        Height of the highlight, in units of full brightness; 0 is Lambertian.
    shininess
        Phong's exponent: larger is a smaller highlight.
    """

    code = PLAIN
    gloss: float = 0.0
    shininess: float = 20.0

    def numbers(self) -> tuple[float, ...]:
        """At most seven numbers for the ray caster."""
        raise NotImplementedError

    def choices(self) -> tuple[int, int, int]:
        """Three whole numbers for the ray caster; the packing fills in places in tables."""
        return 0, 0, 0


@dataclass(frozen=True)
class Plain(Finish):
    """One albedo everywhere."""

    albedo: float = 0.8

    def numbers(self) -> tuple[float, ...]:
        return (self.albedo, 0.0, 1.0)


@dataclass(frozen=True)
class Checker(Finish):
    """Fields of two albedos; ``size`` is a field's side, ``shift`` moves the pattern by parts of a field.

    ``solid`` cuts the shape out of a block of cubes, ``surface`` lays the fields along its own coordinates.
    """

    light: float = 1.0
    dark: float = 0.35
    size: float = 2.0
    mapping: Mapping = "solid"
    shift: tuple[float, float, float] = (0.5, 0.5, 0.5)
    code = CHECKER

    def numbers(self) -> tuple[float, ...]:
        return (self.light, self.dark, self.size, *self.shift)

    def choices(self) -> tuple[int, int, int]:
        return 0, 0, int(self.mapping == "surface")


@dataclass(frozen=True)
class Noise(Finish):
    """Value noise between two albedos; ``size`` is the largest blob's, each octave about halves it."""

    light: float = 1.0
    dark: float = 0.1
    size: float = 3.0
    octaves: int = 6
    seed: int = 0
    mapping: Mapping = "solid"
    code = NOISE

    def numbers(self) -> tuple[float, ...]:
        return (self.dark, self.light, self.size)

    def choices(self) -> tuple[int, int, int]:
        return self.seed % 65536, self.octaves, int(self.mapping == "surface")


@dataclass(frozen=True, eq=False)
class Picture(Finish):
    """An image between two albedos, mirrored beyond its sides.

    Parameters
    ----------
    image
        float (H, W) in [0, 1].
    pitch
        Size of one of its pixels on the surface.
    mapping
        ``surface`` along the shape's own coordinates, ``solid`` projected along its z axis.
    """

    image: NDArray[np.float64] = field(default_factory=lambda: np.zeros((2, 2)))
    light: float = 1.0
    dark: float = 0.0
    pitch: float = 0.05
    mapping: Mapping = "surface"
    code = PICTURE

    def numbers(self) -> tuple[float, ...]:
        rows, columns = self.image.shape
        return (self.dark, self.light, self.pitch, columns / 2, rows / 2)

    def choices(self) -> tuple[int, int, int]:
        return 0, 0, int(self.mapping == "surface")


@dataclass(frozen=True)
class Split(Finish):
    """One finish on each side of a plane n·p = offset of the shape's frame: two textures, or a partial one."""

    near: Finish = field(default_factory=Plain)
    beyond: Finish = field(default_factory=Plain)
    normal: tuple[float, float, float] = (1.0, 0.0, 0.0)
    offset: float = 0.0
    code = SPLIT

    def numbers(self) -> tuple[float, ...]:
        return (0.0, 0.0, 1.0, *self.normal, self.offset)
