"""A stereo pair with whatever truth there is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint.fields.geometry import depth_from_disparity, normals_from_depth

if TYPE_CHECKING:
    from visint_lab.render.rendering import Rendering

__all__ = ["Pair", "PairFiles"]


@dataclass(frozen=True, eq=False)
class Pair:
    """Images and truth of one scene, registered to the left view.

    Parameters
    ----------
    left, right
        float32 (H, W), linear.
    camera
        With a search range; ``unit`` is ``"relative"`` where there is no calibration.
    disparity
        float32 (H, W), NaN unknown; None if there is no truth.
    visible
        bool (H, W): seen by both cameras; None if not known.
    normals, depth
        Exact ones, of rendered pairs; None if the truth is a disparity map alone.
    """

    name: str
    left: Array
    right: Array
    camera: Camera
    disparity: Array | None = None
    visible: Array | None = None
    depth: Array | None = None
    normals: Array | None = None

    @classmethod
    def of(cls, rendering: Rendering) -> Pair:
        """A rendered scene as a pair."""
        truth = rendering.truth
        maps = (truth.disparity, truth.visible, truth.depth, truth.normals)
        return cls(rendering.scene.name, rendering.left, rendering.right, rendering.camera, *maps)

    def geometry(self, disparity: Array) -> tuple[Array, Array]:
        """(depth, normals) that follow from a disparity map of this pair."""
        depth = depth_from_disparity(disparity, self.camera)
        return depth, normals_from_depth(depth, self.camera)

    @property
    def low_texture(self) -> Array:
        """Bool (H, W): the brightness, as a file holds it, varies by less than 4 of 255 within 9×9 pixels."""
        from scipy.ndimage import uniform_filter

        from visint.io import srgb_from_linear

        grey = srgb_from_linear(self.left).astype(np.float64)
        variance = uniform_filter(grey**2, 9) - uniform_filter(grey, 9) ** 2
        return np.asarray(variance < 4.0**2)


@dataclass(frozen=True)
class PairFiles:
    """Where a pair's files lie and what their numbers mean; :meth:`read` opens them.

    Parameters
    ----------
    disparity, disparity_right
        True disparities: PFM in pixels, or an image of disparity times ``scale``, 0 unknown.
    mask
        255 where both cameras see.
    span
        Search range, pixels, where no calibration tells.
    """

    name: str
    left: Path
    right: Path
    disparity: Path | None = None
    disparity_right: Path | None = None
    mask: Path | None = None
    calibration: Path | None = None
    scale: float = 1.0
    span: tuple[float, float] | None = None

    def read(self) -> Pair:
        """The pair.

        Raises
        ------
        InputError
            If a file is missing, broken or does not fit.
        """
        from visint.io import read_image

        left, right = read_image(self.left), read_image(self.right)
        disparity = self._disparity(self.disparity)
        return Pair(self.name, left, right, self._camera(left), disparity, self._visible(disparity))

    def _camera(self, left: Array) -> Camera:
        from visint.io import read_camera

        if self.calibration is not None:
            return read_camera(self.calibration)
        return Camera.uncalibrated(left.shape[1], left.shape[0], self.span)

    def _disparity(self, path: Path | None) -> Array | None:
        from visint.io import read

        if path is None:
            return None
        if path.suffix == ".pfm":
            return np.where(np.isfinite(found := read(path, "Disparity")), found, np.float32(np.nan))
        samples = _grey(path).astype(np.float32)
        return np.where(samples > 0, samples / np.float32(self.scale), np.float32(np.nan))

    def _visible(self, disparity: Array | None) -> Array | None:
        if disparity is None:
            return None
        if self.mask is not None:
            return np.asarray(_grey(self.mask) == 255)
        right = self._disparity(self.disparity_right)
        return None if right is None else _agreeing(disparity, right)


def _grey(path: Path) -> Array:
    """The samples (H, W) as stored; of a colour file its first channel."""
    from visint.io import read_raster

    stored = read_raster(path)
    if stored.samples.ndim == 2:
        return stored.samples
    return np.asarray(stored.samples[..., 0])


def _agreeing(left: Array, right: Array) -> Array:
    """Bool (H, W): where the right view's truth is the left's within 1 px."""
    columns = np.arange(left.shape[1]) - np.nan_to_num(left)
    place = np.round(columns).astype(int)
    there = np.take_along_axis(right, np.clip(place, 0, left.shape[1] - 1), axis=1)
    return np.asarray(np.isfinite(left) & (place >= 0) & (np.abs(there - left) <= 1))
