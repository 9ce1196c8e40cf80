"""How the objects of the sets stand: one pose of each by choice, all others from a seed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from visint_lab.rays.rig import Matrix
from visint_lab.rays.scene import turned

__all__ = ["CHOSEN", "Pose", "random_pose"]


@dataclass(frozen=True)
class Pose:
    """A rotation and a size relative to the chosen one."""

    rotation: Matrix
    scale: float = 1.0


CHOSEN = {
    "parallelepiped": Pose(turned(0.55, 0.65, 0.0)),
    "sphere": Pose(turned()),
    "ellipsoid": Pose(turned(0.3, 0.5, 0.4)),
    "cylinder": Pose(turned(1.25, 0.0, 0.35)),
    "paraboloid": Pose(turned(0.25, 0.2, 0.0)),
    "hyperboloid": Pose(turned(1.35, 0.0, -0.2)),
    "torus": Pose(turned(0.6, 0.25, 0.0)),
}


def random_pose(name: str, seed: int) -> Pose:
    """A pose of object ``name`` drawn from ``seed``: uniform over rotations, size 0.7 to 1.

    A paraboloid keeps its bowl's outside in view: its axis stays within 50° of the line of sight.
    """
    rng = np.random.default_rng((seed, *name.encode()))
    scale = float(rng.uniform(0.7, 1.0))
    if name == "paraboloid":
        tilt, way = math.radians(50) * math.sqrt(rng.uniform()), rng.uniform(0, 2 * math.pi)
        return Pose(turned(tilt * math.cos(way), tilt * math.sin(way), rng.uniform(0, 2 * math.pi)), scale)
    from scipy.spatial.transform import Rotation

    matrix = Rotation.random(rng=rng).as_matrix()
    return Pose(tuple(map(tuple, matrix.tolist())), scale)  # type: ignore[arg-type]
