"""Single rays: what exactly is to be seen at points of an image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visint_lab.rays.rig import Pinhole
from visint_lab.rays.scene import Scene
from visint_lab.rays.shapes import Mesh
from visint_lab.render.packing import Packed, pack

__all__ = ["Prober", "Sight"]


@dataclass(frozen=True, eq=False)
class Sight:
    """What rays see: arrays of the shape of the probed points.

    ``depth`` is NaN where nothing is met; there ``thing`` is −1. ``normals`` are in the camera's frame.
    ``mark`` changes where the albedo jumps; ``seen`` says that the other camera's line of sight is free.
    """

    depth: NDArray[np.float64]
    normals: NDArray[np.float64]
    thing: NDArray[np.int64]
    face: NDArray[np.int64]
    mark: NDArray[np.int64]
    lit: NDArray[np.bool_]
    albedo: NDArray[np.float64]
    brightness: NDArray[np.float64]
    seen: NDArray[np.bool_]


class Prober:
    """Casts single rays of one camera into a scene."""

    def __init__(self, scene: Scene, view: Pinhole, other: Pinhole, packed: Packed | None = None) -> None:
        self.view = view
        self._packed = packed if packed is not None else pack(scene)
        self._lamp = scene.lamp.numbers(scene.background)
        self._other = other
        self.of_mesh = np.array([isinstance(thing.shape, Mesh) for thing in scene.things])
        """(things,): which are made of triangles."""

    def __call__(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> Sight:
        """What is seen at image points (u, v), pixels, of any common shape."""
        from visint_lab.render import _kernels as k

        spots = np.ascontiguousarray(np.stack([u, v], axis=-1).reshape(-1, 2), dtype=np.float64)
        out = np.empty((len(spots), k.COLUMNS))
        k.probe(self._packed, self._lamp, self.view.eye, self.view.aim, self._other.eye, spots, out)
        out = out.reshape((*np.shape(u), k.COLUMNS))
        return Sight(
            depth=out[..., k.DEPTH],
            normals=out[..., k.NX : k.NZ + 1] @ np.asarray(self.view.rotation).T,
            thing=out[..., k.THING].astype(np.int64),
            face=out[..., k.FACE].astype(np.int64),
            mark=out[..., k.MARK].astype(np.int64),
            lit=out[..., k.LIT] > 0,
            albedo=out[..., k.ALBEDO],
            brightness=out[..., k.BRIGHTNESS],
            seen=out[..., k.SEEN] > 0,
        )

    def whole(self) -> Sight:
        """What is seen at every pixel centre."""
        u, v = np.meshgrid(np.arange(self.view.width, dtype=float), np.arange(self.view.height, dtype=float))
        return self(u, v)
