"""The two set-ups: chapter 4's parallel cameras and chapter 5's converging ones."""

from __future__ import annotations

from visint.errors import UsageError
from visint_lab.rays.finish import Checker, Finish, Noise, Plain, Split
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing
from visint_lab.rays.shapes import Box, Cylinder, Ellipsoid, Hyperboloid, Paraboloid, Shape, Sphere, Torus
from visint_lab.scenes.poses import CHOSEN, Pose
from visint_lab.scenes.surfaces import diligent, mozart

__all__ = ["OBJECTS", "SCANS", "SURFACES", "scanned", "set_a", "set_b"]

OBJECTS = ("parallelepiped", "sphere", "cylinder", "paraboloid", "hyperboloid", "torus")
SCANS = ("bear", "buddha", "cat", "pot1", "reading")
SURFACES = {"a": ("lambertian", "specular"), "b": ("checker",), "mozart": ("no", "partial", "full", "two")}
SURFACES["mozart"] += ("specular",)
ALBEDO = 0.8
PATCHES = Noise(light=0.95, dark=0.25, size=2.4, octaves=4, seed=11)
WEAVE = Noise(light=0.9, dark=0.3, size=0.9, octaves=3, seed=12)


def solid(name: str, scale: float = 1.0) -> Shape:
    """One of the six primitives (or the ellipsoid) at about 9 units' radius times ``scale``."""
    s = scale
    shapes: dict[str, Shape] = {
        "parallelepiped": Box(6.0 * s, 5.0 * s, 4.5 * s),
        "sphere": Sphere(8.5 * s),
        "ellipsoid": Ellipsoid(9.0 * s, 7.0 * s, 6.0 * s),
        "cylinder": Cylinder(5.5 * s, 7.0 * s),
        "paraboloid": Paraboloid(8.0 * s, 5.0 * s),
        "hyperboloid": Hyperboloid(4.5 * s, 6.0 * s, 7.0 * s),
        "torus": Torus(6.5 * s, 2.8 * s),
    }
    if name not in shapes:
        raise UsageError.of("VI701", f"no primitive is named {name!r}", choices=", ".join(shapes))
    return shapes[name]


def _gloss(finish: str) -> Finish:
    if finish == "specular":
        return Plain(0.55, gloss=0.45, shininess=18.0)
    return Plain(ALBEDO)


def set_a(name: str, surface: str, size: int = 512, pose: Pose | None = None) -> Scene:
    """Chapter 4: parallel cameras at (∓5, 0, 0), the object 50 before them, a point light at (0, 0, −100).

    At 512×512 the focal length is 800 px; disparities run from about 140 to 200 px. ``surface`` is
    ``lambertian`` or ``specular``, where an ellipsoid stands for the sphere.
    """
    name = "ellipsoid" if (name, surface) == ("sphere", "specular") else name
    pose = pose or CHOSEN[name]
    thing = Thing(solid(name, pose.scale), _gloss(surface), (0.0, 0.0, 50.0), pose.rotation)
    rig = Rig.parallel((size, size), 800.0 * size / 512, 5.0)
    return Scene(f"a/{name}/{surface}", (thing,), Lamp("point", (0.0, 0.0, -100.0)), rig)


def scanned(name: str, size: int = 512) -> Scene:
    """A scanned figure in chapter 4's set-up, Lambertian: it stands in for scans that are not public."""
    thing = Thing(diligent(name), Plain(ALBEDO), (0.0, 0.0, 50.0))
    rig = Rig.parallel((size, size), 800.0 * size / 512, 5.0)
    return Scene(f"range/{name}", (thing,), Lamp("point", (0.0, 0.0, -100.0)), rig)


def _chapter_5_rig(size: int) -> Rig:
    return Rig.parallel((size, size), 1280.0 * size / 512, 9.0, 90.0).converging_on((0.0, 0.0, 0.0))


def set_b(name: str, surface: str = "checker", size: int = 512, pose: Pose | None = None) -> Scene:
    """Chapter 5: cameras at (∓9, 0, −90) that look at the object at the origin, a point light at (0, 0, −1000).

    At 512×512 the focal length is 1280 px; rectified, disparities run about ±50 px around 0. The primitives
    are cut from a checkered block of albedo 1 and 0.35. Mozart is plain (``no``), textured on one side
    (``partial``), all over (``full``), with ``two`` textures, or ``specular``.
    """
    lamp = Lamp("point", (0.0, 0.0, -1000.0))
    if name == "mozart":
        turn = pose.rotation if pose else CHOSEN["sphere"].rotation
        thing = Thing(mozart(31.0), _mozart_finish(surface), (0.0, 0.0, 0.0), turn)
    else:
        pose = pose or CHOSEN[name]
        checker = Checker(1.0, 0.35, 3.5)
        thing = Thing(solid(name, 1.5 * pose.scale), checker, (0.0, 0.0, 0.0), pose.rotation)
    return Scene(f"b/{name}/{surface}", (thing,), lamp, _chapter_5_rig(size))


def _mozart_finish(surface: str) -> Finish:
    finishes: dict[str, Finish] = {
        "no": Plain(ALBEDO),
        "partial": Split(near=PATCHES, beyond=Plain(0.6)),
        "full": PATCHES,
        "two": Split(near=PATCHES, beyond=WEAVE),
        "specular": _gloss("specular"),
    }
    return finishes[surface]
