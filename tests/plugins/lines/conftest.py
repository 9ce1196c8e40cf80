"""Random scenes of the lab as line drawings with their true labels and junctions."""

from __future__ import annotations

import numpy as np
import pytest

from visint_lab.rays.finish import Checker, Noise, Plain, Split
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Box, Cylinder, Ellipsoid, Hyperboloid, Paraboloid, Plane, Sphere, Torus
from visint_lab.render.rendering import render

KINDS = ("box", "sphere", "ellipsoid", "cylinder", "paraboloid", "hyperboloid", "torus")
SETTINGS = ("alone", "apart", "touching")


def shape(kind, rng, size):
    a, b, c = size * rng.uniform(0.65, 1.0, 3)
    return {
        "box": lambda: Box(0.8 * a, 0.8 * b, 0.8 * c),
        "sphere": lambda: Sphere(a),
        "ellipsoid": lambda: Ellipsoid(a, 0.8 * b, 0.8 * c),
        "cylinder": lambda: Cylinder(0.7 * a, b),
        "paraboloid": lambda: Paraboloid(a, 0.8 * b),
        "hyperboloid": lambda: Hyperboloid(0.6 * a, b, b),
        "torus": lambda: Torus(0.9 * a, 0.35 * a),
    }[kind]()


def finish(marks, rng):
    if marks == "checker":
        return Checker(1.0, 0.35, float(rng.uniform(1.4, 2.0)))
    if marks == "two":
        normal = rng.normal(size=3)
        return Split(near=Plain(0.9), beyond=Plain(0.4), normal=tuple(normal / np.linalg.norm(normal)))
    return Noise(
        light=0.95, dark=0.05, size=float(rng.uniform(1.0, 1.6)), octaves=5, seed=int(rng.integers(1e6))
    )


def scene(seed, size=256, marks=""):
    """One thing, two apart or two that reach into each other, before a wall: by the seed, in turn.

    A thing lies at about 17, the wall at 24; half the field of view is 6.5 at the things.
    """
    rng = np.random.default_rng((seed, 40))
    setting = SETTINGS[seed % 3]
    first = KINDS[(seed // 3) % 7]
    kinds = [first] if setting == "alone" else [first, KINDS[int(rng.integers(7))]]
    things = []
    way = rng.uniform(0, 2 * np.pi)
    for i, kind in enumerate(kinds):
        large = {"alone": 4.2, "apart": 2.7, "touching": 3.2}[setting]
        off = 0.0 if setting == "alone" else (i - 0.5) * (6.2 if setting == "apart" else 3.6)
        where = (off * np.cos(way), off * np.sin(way), 17.0 + rng.uniform(-0.6, 0.6))
        from scipy.spatial.transform import Rotation

        pose = tuple(map(tuple, Rotation.random(rng=rng).as_matrix().tolist()))
        things.append(Thing(shape(kind, rng, large), finish(marks, rng), where, pose))
    wall = Noise(light=0.8, dark=0.05, size=2.4, seed=int(rng.integers(1e6)))
    tilt = turned(rng.uniform(-0.15, 0.15), rng.uniform(-0.2, 0.2))
    things.append(Thing(Plane(), wall, (0.0, 0.0, 24.0), tilt))
    lamp = Lamp("distant", (-0.45, -0.6, -1.0), ambient=0.12, shadows=False)
    return Scene(f"lines#{seed}", tuple(things), lamp, Rig.parallel((size, size), 1.3 * size, 0.7))


def marked(truth):
    """The true regions of the things, each cut where its albedo jumps: a drawing with the marks drawn in."""
    tone = np.unique(truth.albedo.round(3), return_inverse=True)[1].reshape(truth.albedo.shape)
    frame = np.concatenate([truth.regions[0], truth.regions[-1], truth.regions[:, 0], truth.regions[:, -1]])
    tone = np.where(truth.regions == np.bincount(frame).argmax(), 0, tone)
    return (truth.regions * (int(tone.max()) + 1) + tone + 1).astype(np.int32)


@pytest.fixture(scope="session")
def lab():
    """``lab(seed, size)``: the rendered scene, once a session."""
    made = {}

    def get(seed, size=256, marks="", samples=1):
        key = (seed, size, marks, samples)
        if key not in made:
            made[key] = render(scene(seed, size, marks), samples)
        return made[key]

    return get
