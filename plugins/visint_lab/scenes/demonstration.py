"""The demonstration's scene."""

from __future__ import annotations

from visint_lab.rays.finish import Noise
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Plane, Sphere

__all__ = ["sphere_before_plane"]


def sphere_before_plane(size: int = 512, seed: int = 0) -> Scene:
    """A textured sphere before a slanted textured plane, lit from the upper left; disparities 11 % of ``size``.

    Parameters
    ----------
    size
        Rows and columns of each image; everything else scales with it.
    seed
        Of the two textures.
    """
    ball = Thing(Sphere(3.0), Noise(light=0.95, dark=0.05, size=1.6, seed=2 * seed), (0.4, 0.1, 17.0))
    wall = Thing(
        Plane(),
        Noise(light=0.8, dark=0.05, size=2.6, seed=2 * seed + 1),
        (0.0, 0.0, 21.0),
        turned(0.12, -0.25),
    )
    rig = Rig.parallel((size, size), 1.3 * size, 0.7)
    lamp = Lamp("distant", (-0.45, -0.6, -1.0), ambient=0.12)
    return Scene("sphere_before_plane", (ball, wall), lamp, rig)
