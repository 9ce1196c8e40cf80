"""Wire frames of surfaces over an image."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from visint.arrays import Array
from visint.fields import Camera

__all__ = ["drawn"]

COLORS = ((1.0, 0.55, 0.15), (0.25, 0.75, 1.0), (0.55, 1.0, 0.35), (1.0, 0.4, 0.8), (1.0, 0.95, 0.3))


def drawn(image: Array, wires: Sequence[Array], camera: Camera) -> Array:
    """float32 (H, W, 3), linear: the image darkened, each mesh (R, C, 3) over it in a colour of its own.

    Lines on the far side, whose cells turn away from the camera, are left out.
    """
    import cv2

    ground = np.repeat(np.clip(np.nan_to_num(image), 0, 1)[..., None] * 0.5, 3, axis=-1).astype(np.float32)
    canvas = np.ascontiguousarray(ground)
    for number, wire in enumerate(wires):
        spots, near = _projected(wire, camera)
        for line, visible in ((spots, near), (spots.transpose(1, 0, 2), near.T)):
            for path, seen in zip(line, visible, strict=True):
                both = seen[1:] | seen[:-1]
                pieces = [np.rint(path[i : i + 2] * 16).astype(np.int32) for i in np.flatnonzero(both)]
                cv2.polylines(canvas, pieces, False, COLORS[number % len(COLORS)], 1, cv2.LINE_AA, 4)
    return np.clip(canvas, 0, 1)


def _projected(wire: Array, camera: Camera) -> tuple[Array, Array]:
    """(image points (R, C, 2), bool (R, C): on the side that faces the camera)."""
    depth = np.maximum(wire[..., 2:], 1e-9)
    spots = wire[..., :2] / depth * camera.focal_length + np.array([camera.cx, camera.cy])
    middle = wire.reshape(-1, 3).mean(axis=0)
    normal = np.cross(np.gradient(wire, axis=0), np.gradient(wire, axis=1))
    outward = normal * np.sign((normal * (wire - middle)).sum(axis=-1, keepdims=True))
    return np.clip(spots, -1e4, 1e4), (outward * wire).sum(axis=-1) <= 0
