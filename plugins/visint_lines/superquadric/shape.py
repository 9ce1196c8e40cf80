"""A superquadric: where its surface is, and how far points lie from it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Superquadric", "mesh", "misfit", "rotation_of"]

SQUAREST, ROUNDEST = 0.06, 1.9


class Superquadric(NamedTuple):
    """((x/a)^(2/ε₂) + (y/b)^(2/ε₂))^(ε₂/ε₁) + (z/c)^(2/ε₁) = 1 in a frame of its own.

    Parameters
    ----------
    size
        (a, b, c), half-axes in the unit of the baseline.
    roundness
        (ε₁, ε₂): 0.06 is square, 1 round, towards 2 pinched; along z, and around it.
    turn
        Rotation vector, radians: from the own frame to the camera's.
    place
        (x, y, z) of the centre in the camera's frame.
    """

    size: tuple[float, float, float]
    roundness: tuple[float, float]
    turn: tuple[float, float, float]
    place: tuple[float, float, float]

    def vector(self) -> Array:
        """The eleven numbers, sizes as logarithms."""
        return np.array([*np.log(self.size), *self.roundness, *self.turn, *self.place])

    @classmethod
    def of(cls, vector: Array) -> Superquadric:
        """The inverse of :meth:`vector`."""
        told = [float(v) for v in vector]
        a, b, c = (float(np.exp(v)) for v in told[:3])
        return cls((a, b, c), (told[3], told[4]), (told[5], told[6], told[7]), (told[8], told[9], told[10]))


def rotation_of(turn: Array) -> Array:
    """(3, 3): the rotation by a vector (3,), after Rodrigues."""
    angle = float(np.linalg.norm(turn))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = np.asarray(turn) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def inside_outside(shape: Superquadric, points: Array) -> Array:
    """F (N,): 1 on the surface, below 1 inside, of points (N, 3) in the camera's frame."""
    own = (points - np.asarray(shape.place)) @ rotation_of(np.asarray(shape.turn))
    e1, e2 = shape.roundness
    x, y, z = np.maximum(np.abs(own / np.asarray(shape.size)), 1e-6).T
    around = (x ** (2 / e2) + y ** (2 / e2)) ** (e2 / e1)
    return np.asarray(around + z ** (2 / e1))


def misfit(shape: Superquadric, points: Array) -> Array:
    """(N,): signed distance of points (N, 3) from the surface, measured along the ray from its centre.

    |p| (1 − F^(−ε₁/2)): Gross and Boult's radial distance (1988, DOI 10.1109/CCV.1988.590053).
    """
    away = np.linalg.norm(points - np.asarray(shape.place), axis=1)
    return np.asarray(away * (1 - inside_outside(shape, points) ** (-shape.roundness[0] / 2)))


def mesh(shape: Superquadric, rows: int = 17, columns: int = 33) -> Array:
    """(rows, columns, 3): points of the surface in the camera's frame along its parallels and meridians."""
    e1, e2 = shape.roundness
    eta = np.linspace(-np.pi / 2, np.pi / 2, rows)[:, None]
    omega = np.linspace(-np.pi, np.pi, columns)[None]
    own = np.stack(
        [
            _power(np.cos(eta), e1) * _power(np.cos(omega), e2),
            _power(np.cos(eta), e1) * _power(np.sin(omega), e2),
            _power(np.sin(eta), e1) * np.ones_like(omega),
        ],
        axis=-1,
    )
    return np.asarray((own * np.asarray(shape.size)) @ rotation_of(np.asarray(shape.turn)).T + shape.place)


def _power(value: Array, exponent: float) -> Array:
    return np.asarray(np.sign(value) * np.abs(value) ** exponent)
