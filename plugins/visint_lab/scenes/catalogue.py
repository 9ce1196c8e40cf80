"""The names of the sets' scenes, and what they mean."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from visint.errors import UsageError
from visint_lab.rays.scene import Grain, Scene
from visint_lab.scenes.demonstration import sphere_before_plane
from visint_lab.scenes.poses import Pose, random_pose
from visint_lab.scenes.sets import OBJECTS, SCANS, SURFACES, scanned, set_a, set_b

__all__ = ["NOISES", "names", "scene"]

NOISES: Mapping[str, Grain] = {
    "": Grain(),
    "2%": Grain(additive=0.02),
    "10%": Grain(additive=0.10),
    "x10%": Grain(multiplicative=0.10),
}
"""Noise by the end of a name: parts of full brightness, or of the pixel's own (``x``)."""

_OF_SET = {"a": ("", "2%"), "b": ("", "10%", "x10%"), "r": ("", "2%")}


def names(which: str = "") -> tuple[str, ...]:
    """Every scene's name; of ``a``, ``b`` or ``range`` only if asked."""
    plain = [f"a/{name}/{surface}" for surface in SURFACES["a"] for name in OBJECTS]
    plain += [f"b/{name}/checker" for name in OBJECTS] + [
        f"b/mozart/{surface}" for surface in SURFACES["mozart"]
    ]
    plain += [f"range/{name}" for name in SCANS]
    noisy = [f"{name}+{noise}" if noise else name for name in plain for noise in _OF_SET[name[0]]]
    return tuple(name for name in noisy if name.startswith(which))


def scene(name: str, size: int = 512, seed: int | None = None) -> Scene:
    """The scene ``name``, rows and columns ``size``.

    Parameters
    ----------
    seed
        Of a random pose and size of the object; the chosen pose if not given.

    Raises
    ------
    UsageError
        If there is no such scene.
    """
    if name == "demo":
        return sphere_before_plane(size, seed or 0)
    if name not in names():
        raise UsageError.of("VI701", f"no scene is named {name!r}", choices=", ".join((*names(), "demo")))
    plain, _, noise = name.partition("+")
    made = _made(plain, size, seed)
    return replace(made, name=name if seed is None else f"{name}#{seed}", grain=NOISES[noise])


def _made(plain: str, size: int, seed: int | None) -> Scene:
    if plain.startswith("range/"):
        return scanned(plain.removeprefix("range/"), size)
    which, thing, surface = plain.split("/")
    shown = "ellipsoid" if (thing, surface) == ("sphere", "specular") else thing
    pose: Pose | None = None if seed is None else random_pose(shown, seed)
    if thing == "mozart":
        return set_b(thing, surface, size)  # a relief has no other side to turn to
    return (set_a if which == "a" else set_b)(thing, surface, size, pose)
