"""From an unrectified rig to a rectified pair (Fusiello, Trucco and Verri 2000, as in OpenCV)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from visint.arrays import Array, read_only
from visint.errors import InputError
from visint.fields.camera import Camera

__all__ = ["Rig", "View", "pair_camera", "rectified"]

_MOST_SIDE = 32766
"""Rows and columns of an image that OpenCV warps."""
_SAME = 1e-6


@dataclass(frozen=True, slots=True)
class View:
    """One camera of a rig, and how its image becomes rectified.

    Parameters
    ----------
    matrix, distortion
        3 × 3, and 4, 5, 8, 12 or 14 coefficients in OpenCV's order: k₁ k₂ p₁ p₂ k₃ ….
    size
        (rows, columns) of its image as it is taken.
    rotation
        3 × 3, from this camera's frame to that of the rectified pair.
    projection
        3 × 3, the intrinsic matrix after rectification.
    """

    matrix: Array
    distortion: Array
    size: tuple[int, int]
    rotation: Array
    projection: Array


@dataclass(frozen=True, slots=True)
class Rig:
    """Two cameras: ``x₂ = R x₁ + T``; sizes are (rows, columns)."""

    name: str
    matrices: tuple[Array, Array]
    distortions: tuple[Array, Array]
    rotation: Array
    translation: Array
    size: tuple[int, int]
    unit: str

    def rectification(self) -> tuple[Camera, tuple[View, View] | None]:
        """The camera of the rectified pair, and how to get there; None if nothing is to be done.

        Both images are turned by half the angle between them, and scaled so that no pixel is empty.

        Raises
        ------
        InputError
            VI306 if the cameras do not stand side by side, the left one first, or do not look the same way.
        """
        import cv2

        self._check_sides()
        if self._is_rectified():
            return self._as_it_is(), None
        rows, columns = self.size
        try:
            turns = cv2.stereoRectify(
                self.matrices[0], self.distortions[0], self.matrices[1], self.distortions[1],
                (columns, rows), self.rotation, self.translation[:, None],
                flags=cv2.CALIB_ZERO_DISPARITY, alpha=0,
            )  # fmt: skip
        except cv2.error:
            raise self._wrong("cannot be rectified: OpenCV finds no common plane") from None
        camera = pair_camera(turns[2], turns[3], self.size, self.unit)
        longest = 10 * max(float(matrix[0, 0]) for matrix in self.matrices)
        if camera is None or camera.focal_length > longest:
            raise self._wrong("cannot be rectified: its two cameras hardly see anything in common")
        return camera, self.views((turns[0], turns[1]), (turns[2], turns[3]))

    def views(self, rotations: tuple[Array, Array], projections: tuple[Array, Array]) -> tuple[View, View]:
        """How both images are rectified by 3 × 3 ``rotations`` and 3 × 4 ``projections``."""
        left, right = (
            View(self.matrices[i], self.distortions[i], self.size, rotations[i], projections[i][:, :3])
            for i in (0, 1)
        )
        return left, right

    def _check_sides(self) -> None:
        centre = -self.rotation.T @ self.translation
        if max(abs(centre[1]), abs(centre[2])) > abs(centre[0]):
            raise self._wrong("has its cameras above or behind each other; wants them side by side")
        if centre[0] < 0:
            raise self._wrong("has its second camera left of the first; wants the left one first: swap the two")

    def _is_rectified(self) -> bool:
        first, second = self.matrices
        aligned = np.abs(self.rotation - np.eye(3)).max() < _SAME
        level = np.abs(self.translation[1:]).max() < _SAME * abs(self.translation[0])
        lengths = (first[0, 0], first[1, 1], second[0, 0], second[1, 1])
        alike = max(lengths) - min(lengths) < _SAME * lengths[0] and abs(first[1, 2] - second[1, 2]) < _SAME
        undistorted = not any(np.any(one) for one in self.distortions)
        return bool(aligned and level and alike and undistorted)

    def _as_it_is(self) -> Camera:
        shift = self.matrices[1] @ np.array([float(self.translation[0]), 0, 0])
        camera = pair_camera(
            np.column_stack([self.matrices[0], np.zeros(3)]),
            np.column_stack([self.matrices[1], shift]),
            self.size,
            self.unit,
        )
        assert camera is not None
        return camera

    def _wrong(self, found: str) -> InputError:
        error = InputError.of("VI306", found, where=self.name)
        assert isinstance(error, InputError)
        return error


def pair_camera(left: Array, right: Array, size: tuple[int, int], unit: str) -> Camera | None:
    """The camera of a rectified pair from its 3 × 4 projections in one frame; None if there is no such pair.

    The baseline is ``−(P₂[0,3] − P₁[0,3]) / f``, ``doffs`` the difference of the principal points.
    """
    focal = float(left[0, 0])
    baseline = -(float(right[0, 3]) - float(left[0, 3])) / focal if focal > 0 else math.nan
    if not (math.isfinite(focal) and math.isfinite(baseline) and baseline > 0):
        return None
    return Camera(
        focal_length=focal, cx=float(left[0, 2]), cy=float(left[1, 2]), baseline=baseline,
        doffs=float(right[0, 2] - left[0, 2]), width=size[1], height=size[0], unit=unit,
    )  # fmt: skip


def rectified(image: Array, view: View, size: tuple[int, int]) -> Array:
    """``image``, float32 (H, W) or (H, W, 3), of ``view``, as the rectified camera of ``size`` sees it.

    Raises
    ------
    InputError
        VI307 if the image has another size than was calibrated.
    """
    import cv2

    if image.shape[:2] != view.size:
        found = f"the camera was calibrated at {view.size[1]} × {view.size[0]} pixels, the image is of "
        raise InputError.of("VI307", f"{found}{image.shape[1]} × {image.shape[0]}")
    if max(*view.size, *size) > _MOST_SIDE:
        raise InputError.of("VI303", f"an image of more than {_MOST_SIDE} rows or columns is not rectified")
    x, y = cv2.initUndistortRectifyMap(
        view.matrix, view.distortion, view.rotation, view.projection, size[::-1], cv2.CV_32FC1
    )
    warped = cv2.remap(image, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    known = image[np.isfinite(image)]
    warped = np.clip(warped, known.min(), known.max()) if known.size else warped
    rows, columns = view.size
    warped[(x < -0.5) | (x > columns - 0.5) | (y < -0.5) | (y > rows - 0.5)] = np.nan
    return read_only(np.asarray(warped, dtype=np.float32))
