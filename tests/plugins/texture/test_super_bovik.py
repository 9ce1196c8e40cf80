"""Normals from texture: planes of known slant, bent surfaces, and what must not be believed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from visint.arrays import Array
from visint.module import Context
from visint_lab.rays.finish import Checker
from visint_lab.rays.scene import Grain
from visint_lab.render.rendering import Rendering, render
from visint_lab.scenes.catalogue import scene
from visint_lab.scenes.sets import set_b
from visint_texture.moments import Moments, MomentsInputs, MomentsParams
from visint_texture.super_bovik import SuperBovik, SuperBovikInputs, SuperBovikOutputs, SuperBovikParams

SLANTS = np.radians([20, 35, 50, 65])
TILTS = np.arange(8) * np.pi / 4 - 3


def recovered(image: Array, mode: str = "auto", **ports: Any) -> SuperBovikOutputs:
    seen = Moments().run(MomentsInputs(image=image), Context())
    inputs = SuperBovikInputs(moments=seen.moments, texture=seen.texture, **ports)
    return SuperBovik(SuperBovikParams.model_validate({"mode": mode})).run(inputs, Context())


def known_at(normals: Array, row: int, column: int) -> dict[str, Array]:
    """The map's ports with the truth in one place of 33×33 px, and nothing elsewhere."""
    confidence = np.zeros(normals.shape[:2], np.float32)
    confidence[max(0, row - 16) : row + 17, max(0, column - 16) : column + 17] = 1
    there = np.where(confidence[..., None] > 0, normals, np.nan).astype(np.float32)
    return {"normals": there, "depth_confidence": np.where(np.isfinite(there[..., 0]), confidence, 0)}


def error(found: Array, truth: Array) -> Array:
    """Angles in degrees."""
    return np.degrees(np.arccos(np.clip((found * truth).sum(axis=-1), -1, 1)))


def median_error(plate: Any, mode: str) -> tuple[float, float]:
    """Of a slanted plate: its median error in degrees and median reliability, where the cue speaks."""
    truth = np.broadcast_to(plate.normal.astype(np.float32), (*plate.image.shape, 3))
    middle = plate.image.shape[0] // 2
    ports = known_at(truth, middle, middle) if mode == "reference" else {}
    evidence = recovered(plate.image, mode, camera=plate.camera, **ports).normals
    speaks = evidence.reliability > 0
    return float(np.median(error(evidence.value, truth)[speaks])), float(
        np.median(evidence.reliability[speaks])
    )


@pytest.mark.parametrize(("slant", "tilt"), [(0.4, 0.3), (0.9, -2.0)])
def test_a_plane_needs_no_reference(slanted: Callable, blobs: Callable[..., Array], slant: float, tilt: float):
    """Perspective alone tells the slant of one plane within 6°."""
    wrong, trust = median_error(slanted(blobs(11), slant, tilt), "plane")
    assert wrong < 6
    assert trust > 0.5


def test_a_plane_from_its_reference(slanted: Callable, blobs: Callable[..., Array]):
    """One place of known orientation tells that of all others."""
    assert median_error(slanted(blobs(12), 0.7, 1.0), "reference")[0] < 4


def test_without_reference_or_permission_it_is_silent(blobs: Callable[..., Array]):
    """Mode ``reference`` abstains where the map knows nothing."""
    assert (recovered(blobs(13)[:192, :192], "reference").normals.reliability == 0).all()


def test_nothing_is_said_of_plain_surfaces():
    """Shading and outlines, with noise, are no texture: reliability at most 0.1, also with a perfect map."""
    shown = render(scene("a/cylinder/lambertian+2%", 256), samples=2)
    sure = shown.truth.foreground.astype(np.float32)
    found = recovered(shown.left, normals=shown.truth.normals, depth_confidence=sure, camera=shown.camera)
    assert found.normals.reliability.max() <= 0.1


@pytest.mark.parametrize("lean", [0.0, 0.6])
@pytest.mark.parametrize("known", [False, True])
def test_a_cylinder_with_circular_stripes_is_not_believed(lean: float, known: bool):
    """Fig. 5.8: the stripes seem to lie on a flat surface; the cue must not be sure of that."""
    size, radius = 320, 100.0
    y, x = np.mgrid[:size, :size] - size / 2
    inside, height = np.abs(x) < radius, np.sqrt(np.clip(1 - (x / radius) ** 2, 0, 1))
    along = (y + np.sin(lean) * radius * (1 - height)) / np.cos(lean)
    stripes = 0.5 + 0.35 * np.sin(2 * np.pi * along / 12)
    image = np.where(inside, stripes * (0.3 + 0.7 * height), 0.02)
    image = np.clip(image + 0.01 * np.random.default_rng(0).standard_normal(image.shape), 0, 1)
    normals = np.stack([x / radius, 0 * x, -height], axis=-1).astype(np.float32)
    ports = known_at(normals, size // 2, size // 2) if known else {}
    assert recovered(image.astype(np.float32), **ports).normals.reliability.max() <= 0.1


def checkered(shape: str, size: float) -> Rendering:
    """Chapter 5's view of a solid cut from a block of checkers, at 2 % noise."""
    made = set_b(shape, "checker", 512)
    thing = replace(made.things[0], finish=Checker(1.0, 0.35, size))
    return render(replace(made, things=(thing,), grain=Grain(additive=0.02)), samples=3)


def bent_error(shape: str, size: float) -> float:
    """Median error inside the largest face, one reference site at its most frontal place."""
    import cv2

    shown = checkered(shape, size)
    regions, truth = shown.truth.regions, shown.truth.normals
    largest = regions == np.bincount(regions[shown.truth.foreground]).argmax()
    inner = cv2.erode(largest.astype(np.uint8), np.ones((33, 33), np.uint8)) > 0
    frontal = cv2.blur(np.where(inner, -truth[..., 2], 0).astype(np.float32), (9, 9))
    row, column = np.unravel_index(frontal.argmax(), frontal.shape)
    ports = known_at(truth, int(row), int(column))
    found = recovered(shown.left, camera=shown.camera, regions=regions.astype(np.int32), **ports).normals
    return float(np.median(error(found.value, truth)[inner & (found.reliability > 0)]))


def test_a_checkered_paraboloid():
    """A bent surface from one reference site, at 2 % noise: median error at most 8° inside."""
    assert bent_error("paraboloid", 1.0) <= 8


@pytest.mark.slow
def test_bent_surfaces():
    """Sphere, cylinder and paraboloid, checkers of two sizes: their middle median error is at most 8°.

    Single ones may be over: a block's checkers are not the same texture on every cut through them.
    """
    errors = [bent_error(shape, size) for shape in ("sphere", "cylinder", "paraboloid") for size in (0.7, 1.0)]
    assert np.median(errors) <= 8, errors
    assert max(errors) <= 12, errors


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "most"), [("reference", 6), ("plane", 12)])
def test_all_textures(slanted: Callable, brodatz: dict, synthetic: dict, mode: str, most: float):
    """Five Brodatz textures and three made up, slants 20° to 65°, eight tilts: the median error."""
    from scipy.stats import spearmanr

    plates = (
        slanted(texture, slant, tilt, 384)
        for texture in ({**brodatz, **synthetic}).values()
        for slant in SLANTS
        for tilt in TILTS
    )
    wrong, trust = np.array([median_error(plate, mode) for plate in plates]).T
    assert np.median(wrong) <= most
    assert -spearmanr(trust, wrong).statistic > 0.3  # 0.6 is wanted; see the page on texture


@pytest.mark.slow
@pytest.mark.parametrize(("method", "most"), [("gabor", 0.35), ("tensor", 0.06)])
def test_moments_take_no_longer(blobs: Callable[..., Array], method: str, most: float):
    """512×512 on one core, processor time of the best of three."""
    module, image = Moments(MomentsParams.model_validate({"method": method})), blobs(14)
    times = []
    for _ in range(4):
        begun = time.process_time()
        module.run(MomentsInputs(image=image), Context())
        times.append(time.process_time() - begun)
    assert min(times) <= most
