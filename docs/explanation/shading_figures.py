"""Draws the figures of the shading page into ``docs/gallery/shading``.

Run from the project's root: ``python docs/explanation/shading_figures.py``. ``bowl_and_sphere.png``: two
surfaces of one image, and what shading makes of each with the depth that the 1992 matcher finds.
``saddle.png``: the saddle of Fig. 3.5, from singular points and by the map's direction. ``reliability.png``:
where shading believes itself. Surfaces are shown lit from the upper left, whatever lit the image.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

import visint
from visint.fields.geometry import depth_from_disparity
from visint.io import encode_png
from visint.module import Context
from visint_lab.rays.finish import Plain
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import HeightMap, Hyperboloid
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_shading.incidence import IncidenceOf
from visint_shading.oliensis_dupuis import OliensisDupuis
from visint_shading.slope import Slope

SIZE = 256
FOLDER = Path(__file__).parent.parent / "gallery" / "shading"
FROM_UPPER_LEFT = np.array([-0.5, -0.6, -0.62])


def dome(sign: float, samples: int = 400):
    """Half of a sphere of radius 8.5 but for its rim, bulging (+1) or hollow (−1)."""
    across = np.linspace(-8.2, 8.2, samples)
    squared = across[None] ** 2 + across[:, None] ** 2
    height = np.where(squared < 8.0**2, np.sqrt(np.maximum(8.5**2 - squared, 0)), np.nan)
    return HeightMap(sign * (height - 5.0), 16.4 / samples)


def seen_from_the_light(shape, rotation=None):
    """The pair, the light at the left camera."""
    rig = Rig.parallel((SIZE, SIZE), 800.0 * SIZE / 512, 5.0)
    thing = Thing(shape, Plain(0.8), (-5.0, 0.0, 50.0), rotation or turned())
    return render(Scene("one", (thing,), Lamp("point", (-5.0, 0.0, 0.01), shadows=False), rig), samples=3)


def given(seen, depth, **more):
    regions = np.where(seen.truth.foreground, 1, 0).astype(np.int32)
    usual = {"image": seen.left, "depth": depth, "regions": regions, "light": seen.light, "camera": seen.camera}
    return {**usual, **more}


def found(module, inputs):
    size = inputs["image"].shape
    chosen = module(module.Params(window=6 * size[0] / 256))
    return chosen.run(module.Inputs(**inputs), Context(size=size))


def matched(seen):
    disparity = visint.run("stereo", left=seen.left, right=seen.right, camera=seen.camera)["disparity"]
    return depth_from_disparity(np.asarray(disparity), seen.camera)


def lit(normals):
    """A surface as light from the upper left shows it; unknown is dark blue."""
    way = FROM_UPPER_LEFT / np.linalg.norm(FROM_UPPER_LEFT)
    known = np.isfinite(normals[..., 2])
    grey = np.where(known, 0.15 + 0.85 * np.maximum(np.nan_to_num(normals) @ way, 0), 0)
    return np.where(known[..., None], grey[..., None], (0.05, 0.05, 0.2))


def plain(image):
    return np.repeat((np.clip(image, 0, 1) ** (1 / 2.2))[..., None], 3, axis=-1)


def trusted(reliability):
    """White is 1."""
    return np.repeat(reliability[..., None], 3, axis=-1)


def middle(panel):
    edge = SIZE // 5
    return panel[edge:-edge, edge:-edge]


def side_by_side(rows):
    gap = 6
    tall = [
        np.hstack([np.pad(middle(p), ((0, 0), (0, gap), (0, 0)), constant_values=1.0) for p in row])
        for row in rows
    ]
    sheet = np.vstack([np.pad(row, ((0, gap), (0, 0), (0, 0)), constant_values=1.0) for row in tall])
    return (255 * np.clip(sheet[:-gap, :-gap], 0, 1)).astype(np.uint8)


def bowl_and_sphere():
    rows = []
    for sign in (1.0, -1.0):
        seen = seen_from_the_light(dome(sign))
        relief = found(OliensisDupuis, given(seen, matched(seen)))
        blind = found(OliensisDupuis, given(seen, None))
        panels = [seen.truth.normals, relief.normals.value, blind.normals.value]
        rows.append([plain(seen.left), *(lit(each) for each in panels)])
        print("bowl" if sign < 0 else "sphere", angle(relief, seen), angle(blind, seen))
    return rows


def angle(answer, seen):
    """Mean angle in degrees away from the rim."""
    there = np.isfinite(answer.normals.value[..., 2]) & (seen.truth.normals[..., 2] < -0.35)
    cosine = (answer.normals.value * seen.truth.normals).sum(axis=-1)[there]
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean())


def saddle():
    seen = seen_from_the_light(Hyperboloid(4.5, 6.0, 7.0), turned(math.pi / 2, 0.0, -0.2))
    depth = matched(seen)
    answers = [found(OliensisDupuis, given(seen, None)), found(Slope, given(seen, depth))]
    print("saddle", [angle(each, seen) for each in answers])
    return [[plain(seen.left), lit(seen.truth.normals), *(lit(each.normals.value) for each in answers)]]


def reliability():
    image, sure = [], []
    for name in ("a/sphere/lambertian+2%", "b/sphere/checker", "a/sphere/specular", "a/torus/lambertian+10%"):
        plain_name, _, noise = name.partition("+")
        seen = render(scene(name if noise != "10%" else plain_name, SIZE), samples=2)
        if noise == "10%":
            seen = render(replace(seen.scene, grain=scene("b/torus/checker+10%", SIZE).grain), samples=2)
        answer = found(IncidenceOf, given(seen, matched(seen)))
        image.append(plain(np.where(seen.truth.foreground, seen.left, 0)))
        sure.append(trusted(answer.incidence.reliability))
        print(name, float(answer.incidence.reliability[seen.truth.foreground].mean()))
    return [image, sure]


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    for figure in (bowl_and_sphere, saddle, reliability):
        (FOLDER / f"{figure.__name__}.png").write_bytes(encode_png(side_by_side(figure())))


if __name__ == "__main__":
    main()
