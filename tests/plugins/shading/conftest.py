"""Surfaces with exact images and known normals for the shading tests."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.module import Context, Module
from visint_lab.rays.finish import Plain
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Grain, Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Cylinder, Hyperboloid, Paraboloid, Sphere, Torus
from visint_lab.render.rendering import render

SOLIDS = {
    "sphere": (Sphere(8.5), turned()),
    "cylinder": (Cylinder(5.5, 7.0), turned(math.pi / 2, 0.0, 0.35)),
    "paraboloid": (Paraboloid(8.0, 5.0), turned()),
    "saddle": (Hyperboloid(4.5, 6.0, 7.0), turned(math.pi / 2, 0.0, -0.2)),
    "torus": (Torus(6.5, 2.8), turned(0.3, 0.2, 0.0)),
}
BEHIND = (0.0, 0.0, -1.0)
OBLIQUE = (0.0, math.sin(math.radians(20)), -math.cos(math.radians(20)))


@dataclass(frozen=True, eq=False)
class View:
    """A view of one solid before darkness, and the truth of it."""

    image: Array
    depth: Array
    normals: Array
    regions: Array
    camera: Camera
    light: Light

    @property
    def figure(self) -> Array:
        """Bool (H, W): where the solid is."""
        return self.regions > 0

    @property
    def away(self) -> Array:
        """Bool (H, W): the figure, away from its limbs (70°) and its outline."""
        import cv2

        side = 2 * max(2, self.image.shape[0] // 64) + 1
        inner = cv2.erode(self.figure.astype(np.uint8), np.ones((side, side), np.uint8)) > 0
        return inner & (self.normals[..., 2] < -0.35)

    def run(
        self, module: type[Module[Any, Any, Any]], params: dict[str, Any] | None = None, **given: Any
    ) -> Any:
        """The module's outputs on this view; ``given`` replaces inputs."""
        inputs = {
            "image": self.image,
            "regions": self.regions,
            "light": self.light,
            "camera": self.camera,
            **given,
        }
        rows = self.image.shape[0]
        chosen = module.Params(**{"window": 6 * rows / 256, **(params or {})})
        return module(chosen).run(module.Inputs(**inputs), Context(size=self.image.shape))

    def error(self, normals: Array) -> Array:
        """Angles in degrees where there are normals away from limbs; at least nine tenths of them."""
        there = self.away & np.isfinite(normals[..., 2])
        assert there.sum() > 0.9 * self.away.sum()
        cosine = (normals * self.normals).sum(axis=-1)[there]
        return np.degrees(np.arccos(np.clip(cosine, -1, 1)))

    def roughly(self, noise: float = 0.05, seed: int = 0) -> Array:
        """Depth as a matcher might give it: evened over 1 % of the width inside the figure, and noisy."""
        import cv2

        middle = float(np.nanmean(self.depth[self.figure]))
        inside = self.figure.astype(np.float32)
        length = 0.01 * self.image.shape[1]
        above = cv2.GaussianBlur(
            np.where(self.figure, self.depth - middle, 0).astype(np.float32), (0, 0), length
        )
        share = np.maximum(cv2.GaussianBlur(inside, (0, 0), length), 1e-3)
        grain = noise * np.random.default_rng(seed).standard_normal(above.shape)
        return np.where(self.figure, middle + above / share + grain, np.nan).astype(np.float32)


@cache
def _view(name: str, lamp: tuple[float, float, float], size: int, noise: float, ambient: float) -> View:
    shape, rotation = SOLIDS[name]
    rig = Rig.parallel((size, size), 800.0 * size / 512, 5.0)
    thing = Thing(shape, Plain(0.8), (-5.0, 0.0, 50.0), rotation)
    place = "distant" if math.hypot(*lamp) < 2 else "point"
    lit = Lamp(place, lamp, ambient=ambient, shadows=False)  # type: ignore[arg-type]
    seen = render(Scene(name, (thing,), lit, rig, grain=Grain(additive=noise)), samples=2)
    truth = seen.truth
    regions = np.where(truth.foreground, truth.regions, 0).astype(np.int32)
    return View(seen.left, truth.depth, truth.normals, regions, seen.camera, seen.light)


@pytest.fixture(scope="session")
def view() -> Callable[..., View]:
    """(name, lamp, size, noise, ambient) -> a view of that solid; lamps longer than 2 are points."""

    def make(
        name: str,
        lamp: tuple[float, float, float] = BEHIND,
        size: int = 192,
        noise: float = 0.0,
        ambient: float = 0.0,
    ) -> View:
        return _view(name, lamp, size, noise, ambient)

    return make
