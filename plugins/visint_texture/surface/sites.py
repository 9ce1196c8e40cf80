"""Sites: a field of moments brought to a coarse lattice, where orientations are estimated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint_texture.geometry.tangent import Positions

__all__ = ["Sites", "laid_out", "spread_out"]


@dataclass(frozen=True, slots=True)
class Sites:
    """What is known at the cells of a lattice.

    ``moments`` float64 (R, C, 3) per squared unit of (U, V); ``weight`` (R, C) in [0, 1], how much texture;
    ``at`` positions over the focal length; ``spacing`` (dU, dV) of the lattice.
    """

    moments: Array
    weight: Array
    at: Positions
    spacing: tuple[float, float]

    @property
    def shape(self) -> tuple[int, int]:
        """(R, C)."""
        return self.weight.shape[0], self.weight.shape[1]

    def within(self, box: tuple[slice, slice], inside: Array) -> Sites:
        """The sites of a box, those not ``inside`` (of the box's size) without weight."""
        at = Positions(self.at.across[box], self.at.down[box])
        return Sites(self.moments[box], np.where(inside, self.weight[box], 0), at, self.spacing)


def laid_out(moments: Array, texture: Array, camera: Camera, cell: int) -> Sites:
    """Sites of about ``cell`` px, from ``moments`` (H, W, 3) in (cycles/px)² and ``texture`` (H, W)."""
    import cv2

    rows, columns = texture.shape
    shape = (max(1, rows // cell), max(1, columns // cell))
    size = shape[::-1]
    weight = cv2.resize(texture, size, interpolation=cv2.INTER_AREA).reshape(shape)
    total = cv2.resize(moments * texture[..., None], size, interpolation=cv2.INTER_AREA).reshape(*shape, 3)
    focal = camera.focal_length
    mean = total.astype(np.float64) / np.maximum(weight, 1e-6)[..., None] * focal**2
    proper = np.isfinite(mean).all(axis=-1) & (mean[..., 0] * mean[..., 2] > mean[..., 1] ** 2 / 4)
    weight = np.where(proper & np.isfinite(weight), weight, 0).astype(np.float64)
    mean = np.where(weight[..., None] > 0, mean, np.array([1.0, 0.0, 1.0]))
    steps = (columns / shape[1], rows / shape[0])
    across = ((np.arange(shape[1]) + 0.5) * steps[0] - 0.5 - camera.cx) / focal
    down = ((np.arange(shape[0]) + 0.5) * steps[1] - 0.5 - camera.cy) / focal
    at = Positions(*np.meshgrid(across, down))
    return Sites(mean, weight, at, (steps[0] / focal, steps[1] / focal))


def spread_out(field: Array, shape: tuple[int, int]) -> Array:
    """A field (R, C) or (R, C, n) at the sites brought to the image's ``shape`` (rows, columns), float32."""
    import cv2

    fine: Array = cv2.resize(field.astype(np.float32), shape[::-1], interpolation=cv2.INTER_LINEAR)
    return fine
