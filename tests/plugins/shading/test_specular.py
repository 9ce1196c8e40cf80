"""Highlights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from visint.fields.geometry import disparity_from_depth
from visint.module import Context
from visint_lab.rays.finish import Plain
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_shading.slope import Slope
from visint_shading.specular import Specular

SIZE = 192


@pytest.fixture(scope="module")
def glossy():
    """Set A's ellipsoid with its highlight, and what is highlight: a tenth brighter than without gloss."""
    made = scene("a/sphere/specular", SIZE)
    seen = render(made, samples=2)
    matte = replace(made.things[0], finish=Plain(made.things[0].finish.albedo))
    plain = render(replace(made, things=(matte,)), samples=2)
    return seen, (seen.left > 1.11 * plain.left + 0.01) & seen.truth.foreground


def inputs(seen, **given):
    regions = np.where(seen.truth.foreground, seen.truth.regions, 0).astype(np.int32)
    usual = {
        "image": seen.left,
        "depth": seen.truth.depth,
        "regions": regions,
        "light": seen.light,
        "camera": seen.camera,
    }
    return {**usual, **given}


def found(seen, **given):
    module = Specular(Specular.Params(window=4.5, margin=0))
    return module.run(Specular.Inputs(**inputs(seen, **given)), Context(size=(SIZE, SIZE)))


def test_a_lobe_is_found(glossy):
    """Most of the highlight, and hardly anything else."""
    seen, truth = glossy
    mask = found(seen).highlights
    assert mask[truth].mean() > 0.75
    assert truth[mask].mean() > 0.9


def test_two_views_see_it_move(glossy):
    """Without a light there is no lobe to look for; the true disparity is enough to see part of it."""
    seen, truth = glossy
    disparity = disparity_from_depth(seen.truth.depth, seen.camera)
    mask = found(seen, light=None, right=seen.right, disparity=disparity).highlights & seen.truth.foreground
    assert mask.any()
    assert truth[mask].mean() > 0.7


def test_colour_gives_it_away():
    """A pale spot on a red sphere."""
    rows, columns = np.mgrid[:64, :64] - 31.5
    height = np.sqrt(np.maximum(1 - (rows**2 + columns**2) / 30**2, 0)).astype(np.float32)
    spot = (np.exp(-((rows + 8) ** 2 + columns**2) / 18) * 0.4).astype(np.float32)
    color = np.clip(height[..., None] * np.float32([0.5, 0.1, 0.1]) + spot[..., None], 0, 0.98)
    given = {"image": color.mean(axis=-1), "color": color}
    mask = Specular(Specular.Params(margin=0)).run(Specular.Inputs(**given), Context(size=(64, 64))).highlights
    assert mask[spot > 0.2].mean() > 0.9
    assert not mask[(spot < 0.01)].any()


def test_matte_surfaces_have_none(view):
    """Shading alone is no highlight, nor is noise."""
    seen = view("sphere", noise=0.02)
    assert seen.run(Specular, depth=seen.roughly()).highlights[seen.figure].mean() < 0.002


def test_masked_they_do_no_harm(glossy):
    """With the highlight, the ellipsoid's brightness contradicts its surface; without, shading speaks again."""
    seen, _ = glossy
    mask = Specular(Specular.Params(window=4.5, faintest=0.03)).run(
        Specular.Inputs(**inputs(seen)), Context(size=(SIZE, SIZE))
    )
    sure = [
        Slope(Slope.Params(window=4.5))
        .run(Slope.Inputs(**inputs(seen, highlights=highlights)), Context(size=(SIZE, SIZE)))
        .normals.reliability[seen.truth.foreground]
        .mean()
        for highlights in (None, mask.highlights)
    ]
    assert sure[0] < 0.05
    assert sure[1] > 0.6
