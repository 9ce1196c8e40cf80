"""Bumpy surfaces to train on: random reliefs with every finish, so that faces and figures are no surprise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from visint_lab.rays.finish import Finish, Noise, Plain, Split
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import HeightMap
from visint_lab.scenes import NOISES
from visint_lab.scenes import scene as named_scene

__all__ = ["CONDITIONS", "staged"]

SAMPLES = 256
CONDITIONS = tuple(
    f"relief/{rig}/{finish}{noise}"
    for rig, noises in (("a", ("", "+2%")), ("b", ("", "+10%")))
    for finish in ("plain", "glossy", "partial", "full", "two")
    for noise in noises
)
"""A rig of either set, a finish, a noise."""


def staged(name: str, size: int, seed: int) -> Scene:
    """A scene of the lab by name, or a random relief ``relief/<rig>/<finish>``, its noise behind a +."""
    if not name.startswith("relief/"):
        return named_scene(name, size, seed)
    plain, _, noise = name.partition("+")
    _, rig, finish = plain.split("/")
    rng = np.random.default_rng((seed, *plain.encode()))
    made = _before(rig, size)
    nod, turn = rng.uniform(-0.3, 0.3, 2).tolist()
    tilt = turned(nod, turn, float(rng.uniform(-3, 3)))
    position = (0.0, 0.0, 50.0) if rig == "a" else (0.0, 0.0, 0.0)
    pitch = (15.0 if rig == "a" else 26.0) / SAMPLES
    thing = Thing(HeightMap(_heights(rng) * pitch, pitch), _finish(finish, seed), position, tilt)
    return replace(made, name=f"{name}#{seed}", things=(thing,), grain=NOISES[noise])


def _before(rig: str, size: int) -> Scene:
    if rig == "a":
        pair = Rig.parallel((size, size), 800.0 * size / 512, 5.0)
        return Scene("relief", (), Lamp("point", (0.0, 0.0, -100.0)), pair)
    pair = Rig.parallel((size, size), 1280.0 * size / 512, 9.0, 90.0).converging_on((0.0, 0.0, 0.0))
    return Scene("relief", (), Lamp("point", (0.0, 0.0, -1000.0)), pair)


def _heights(rng: np.random.Generator) -> NDArray[np.float64]:
    """Bumps of three sizes on a dome or a flat, in samples; NaN outside a wavy outline, some with a step."""
    from scipy.ndimage import gaussian_filter

    y, x = np.mgrid[:SAMPLES, :SAMPLES] / (SAMPLES - 1) * 2 - 1
    field = np.zeros((SAMPLES, SAMPLES))
    for blur, height in ((40, 30), (18, 14), (8, 4)):
        bumps = gaussian_filter(rng.standard_normal(field.shape), blur)
        field += height * rng.uniform(0.3, 1) * bumps / bumps.std()
    radius, angle = np.hypot(x, y * rng.uniform(1, 1.4)), np.arctan2(y, x)
    field += rng.uniform(0, 60) * np.sqrt(np.maximum(1 - radius**2, 0))
    if rng.uniform() < 0.4:
        field += rng.uniform(10, 30) * (np.hypot(x - rng.uniform(-0.4, 0.4), y) < rng.uniform(0.2, 0.4))
    outline = 0.85 + 0.1 * np.sin(rng.integers(2, 5) * angle + rng.uniform(0, 6))
    return np.where(radius < outline, field - field.mean(), np.nan)


def _finish(name: str, seed: int) -> Finish:
    patches = Noise(light=0.95, dark=0.25, size=2.0 + 0.2 * (seed % 5), octaves=4, seed=100 + seed)
    weave = Noise(light=0.9, dark=0.3, size=0.8, octaves=3, seed=200 + seed)
    finishes: dict[str, Finish] = {
        "plain": Plain(0.75),
        "glossy": Plain(0.55, gloss=0.45, shininess=18.0),
        "partial": Split(near=patches, beyond=Plain(0.6)),
        "full": patches,
        "two": Split(near=patches, beyond=weave),
    }
    return finishes[name]
