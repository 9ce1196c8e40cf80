"""Two pinhole cameras, and the rectified pair that stands for them exactly."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from visint.errors import UsageError
from visint.fields import Camera

__all__ = ["Pinhole", "Rig"]

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
UPRIGHT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Pinhole:
    """One camera: x right, y down, z forward in its own frame; pixel centres at integer coordinates.

    ``rotation`` turns scene vectors into the camera's frame (its rows are the camera's axes in the scene).
    """

    focal_length: float
    cx: float
    cy: float
    width: int
    height: int
    centre: Vector
    rotation: Matrix = UPRIGHT

    @property
    def aim(self) -> NDArray[np.float64]:
        """(3, 3): times (u, v, 1) it is the ray through a pixel, in the scene, with depth 1."""
        f = self.focal_length
        inverse = np.array([[1 / f, 0, -self.cx / f], [0, 1 / f, -self.cy / f], [0, 0, 1.0]])
        turned: NDArray[np.float64] = np.asarray(self.rotation).T @ inverse
        return turned

    @property
    def eye(self) -> NDArray[np.float64]:
        """(3,): where it stands in the scene."""
        return np.asarray(self.centre, dtype=np.float64)

    def looking_at(self, target: Vector) -> Pinhole:
        """The same camera turned so that its axis meets ``target`` and its x axis stays level."""
        z = np.asarray(target) - self.eye
        z /= np.linalg.norm(z)
        x = np.cross((0.0, 1.0, 0.0), z)
        x /= np.linalg.norm(x)
        return replace(self, rotation=_rows(x, np.cross(z, x), z))

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(…, 2) image points (u, v) of scene points (…, 3)."""
        local = (points - self.eye) @ np.asarray(self.rotation).T
        centre = np.array([self.cx, self.cy])
        image: NDArray[np.float64] = self.focal_length * local[..., :2] / local[..., 2:] + centre
        return image


def _rows(x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> Matrix:
    return tuple(tuple(float(c) for c in axis) for axis in (x, y, z))  # type: ignore[return-value]


@dataclass(frozen=True)
class Rig:
    """A left and a right camera of one focal length and one image size."""

    left: Pinhole
    right: Pinhole

    @classmethod
    def parallel(
        cls, size: tuple[int, int], focal_length: float, half_baseline: float, back: float = 0.0
    ) -> Rig:
        """Cameras at (∓half_baseline, 0, −back) looking along +z; ``size`` is (rows, columns)."""
        rows, columns = size
        centre = ((columns - 1) / 2, (rows - 1) / 2)
        left = Pinhole(focal_length, *centre, columns, rows, (-half_baseline, 0.0, -back))
        return cls(left, replace(left, centre=(half_baseline, 0.0, -back)))

    def converging_on(self, target: Vector) -> Rig:
        """Both cameras turned to look at ``target``."""
        return Rig(self.left.looking_at(target), self.right.looking_at(target))

    @property
    def baseline(self) -> float:
        """Distance of the two centres."""
        return float(np.linalg.norm(self.right.eye - self.left.eye))

    def rectified(self) -> Rig:
        """The pair with parallel axes, square to the baseline, at the same two centres.

        Each image's middle keeps to its old line of sight, so a converging rig gets two principal points
        (and a camera with ``doffs``). Rendering it casts its own rays: nothing is resampled.
        """
        x = (self.right.eye - self.left.eye) / self.baseline
        forward = np.asarray(self.left.rotation[2]) + np.asarray(self.right.rotation[2])
        y = np.cross(forward, x)
        y /= np.linalg.norm(y)
        axes = _rows(x, y, np.cross(x, y))
        left, right = _recentred(self.left, axes), _recentred(self.right, axes)
        cy = (left.cy + right.cy) / 2
        return Rig(replace(left, cy=cy), replace(right, cy=cy))

    def homography(self, which: str) -> NDArray[np.float64]:
        """(3, 3): from pixels of this rig's ``left`` or ``right`` image to those of its rectified one."""
        before, after = getattr(self, which), getattr(self.rectified(), which)
        mapping = np.linalg.inv(after.aim) @ before.aim
        scaled: NDArray[np.float64] = mapping / mapping[2, 2]
        return scaled

    def camera(self, disparity_range: tuple[float, float] | None = None) -> Camera:
        """The rectified pair as visint knows it.

        Raises
        ------
        UsageError
            If this rig is not rectified.
        """
        if self.left.rotation != self.right.rotation or self.left.cy != self.right.cy:
            raise UsageError.of("VI306", "this rig is not rectified", write="rig.rectified().camera()")
        return Camera(
            focal_length=self.left.focal_length,
            cx=self.left.cx,
            cy=self.left.cy,
            baseline=self.baseline,
            width=self.left.width,
            height=self.left.height,
            doffs=self.right.cx - self.left.cx,
            disparity_range=disparity_range,
            unit="scene",
        )


def _recentred(view: Pinhole, axes: Matrix) -> Pinhole:
    middle = np.array([(view.width - 1) / 2, (view.height - 1) / 2, 1.0])
    sight = np.asarray(axes) @ view.aim @ middle
    f = view.focal_length
    cx, cy = float(middle[0] - f * sight[0] / sight[2]), float(middle[1] - f * sight[1] / sight[2])
    return replace(view, rotation=axes, cx=cx, cy=cy)
