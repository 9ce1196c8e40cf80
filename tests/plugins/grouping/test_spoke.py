"""Grouping inside graphs: as a spoke of a hub, with a library's segmentation, at several levels."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import visint
from visint.module import Context
from visint_grouping.canny import Canny, CannyInputs
from visint_grouping.depth_edges import DepthEdges, DepthEdgesInputs
from visint_grouping.diffuse import Diffuse, DiffuseInputs
from visint_grouping.diffuse import DiffuseParams as Steps
from visint_grouping.edges_of import EdgesOf, EdgesOfInputs
from visint_grouping.perceptual import Perceptual
from visint_grouping.split_merge import SplitMerge, SplitMergeInputs
from visint_grouping.spoke import SOURCES, GroupingInputs
from visint_grouping.voronoi import Voronoi

HERE = Context()


def disc(noise=0.02, size=96):
    """A bright disc in the middle, and where it is."""
    y, x = np.mgrid[:size, :size] - size / 2
    inside = np.hypot(y, x) < size / 4
    grain = np.random.default_rng(5).normal(0, noise, inside.shape)
    return (np.where(inside, 0.7, 0.4) + grain).clip(0, 1).astype(np.float32), inside


@pytest.mark.parametrize("module", [Perceptual, Voronoi])
def test_a_library_s_segmentation_drops_in(module):
    """OpenCV's mean shift stands in for split and merge, SciPy's zero crossings for Canny."""
    from scipy.ndimage import gaussian_laplace

    image, inside = disc()
    grey = np.repeat((255 * image).astype(np.uint8)[..., None], 3, axis=2)
    flat = cv2.pyrMeanShiftFiltering(grey, 8, 30)[..., 0] > 140
    segments = cv2.connectedComponents(flat.astype(np.uint8), connectivity=4)[1].astype(np.int32) + 1
    curve = gaussian_laplace(255 * image, 3.0)
    before = np.stack([np.roll(curve, 1, axis) for axis in (0, 1)])
    edges = ((np.sign(curve) != np.sign(before)) & (np.abs(curve - before) > 0.2)).any(axis=0)
    found = module().run(GroupingInputs(image=image, edges=edges, segments=segments), HERE)
    assert found.regions[48, 48] != found.regions[3, 3]
    assert (found.regions[inside] == found.regions[48, 48]).mean() > 0.85


def test_segmentations_given_or_made_are_the_same():
    """Left alone the spoke asks the plugin's own modules, with their defaults."""
    image, _ = disc()
    edges = Canny().run(CannyInputs(image=image), HERE).boundaries
    segments = SplitMerge().run(SplitMergeInputs(image=image), HERE).regions
    given = Perceptual().run(GroupingInputs(image=image, edges=edges, segments=segments), HERE)
    made = Perceptual().run(GroupingInputs(image=image), HERE)
    assert (given.evidence.value == made.evidence.value).mean() > 0.99


def test_it_is_sure_of_what_all_agree_on():
    """On the disc's outline coherence is high; far from it the cue is sure that there is none."""
    image, _ = disc()
    found = Perceptual().run(GroupingInputs(image=image), HERE)
    on = found.evidence.value
    assert found.evidence.reliability[on].mean() > 0.9
    assert (found.evidence.reliability[:10] == 1).all()
    assert found.support[..., SOURCES.index("edges")][on].mean() > 0.9
    assert not found.support[~on].any()


def test_a_spoke_of_a_hub():
    """The shipped graph on a rendered pair: depth's edges support the boundaries in the second sweep."""
    from visint_lab.render.rendering import render
    from visint_lab.scenes import scene

    pair = render(scene("demo", 96), samples=1)
    result = visint.run(visint.load("grouping"), left=pair.left, right=pair.right, camera=pair.camera)
    assert result["boundaries"].any()
    assert result["support"][..., SOURCES.index("depth")].any()
    assert result["support"][..., SOURCES.index("map")].any()
    assert result["regions"].max() >= 2
    assert result.confidence["boundaries"][result["boundaries"]].mean() > 0.3


def test_depth_edges_are_jumps():
    """A slanted plane has none, a step has one line of them, beside unknown depth there are none."""
    x = np.arange(80, dtype=np.float32)[None].repeat(60, 0)
    plane = 20 / (1 - 0.004 * x)
    step = np.where(x < 40, 20, 26).astype(np.float32)

    def edges(depth):
        return DepthEdges().run(DepthEdgesInputs(depth=depth.astype(np.float32)), HERE).boundaries

    assert not edges(plane).any()
    assert (edges(step)[5:-5].sum(axis=1) == 1).all()
    assert np.flatnonzero(edges(step)[30])[0] in (39, 40)
    step[:, 36:44] = np.nan
    assert not edges(step).any()


def test_edges_of_regions():
    """Label 0, and the pixel before a change of label."""
    regions = np.array([[1, 1, 2], [1, 0, 2]], np.int32)
    found = EdgesOf().run(EdgesOfInputs(regions=regions), HERE).boundaries
    assert found.tolist() == [[False, True, False], [True, True, False]]


def test_diffusion_stops_at_boundaries():
    """A noisy step with a boundary: noise falls to a third, the step stays as sharp as it was."""
    step = np.where(np.arange(80) < 40, 10, 12)[None].repeat(60, 0)
    noisy = (step + np.random.default_rng(6).normal(0, 0.1, step.shape)).astype(np.float32)
    walls = np.zeros(step.shape, bool)
    walls[:, 39] = True
    found = Diffuse(Steps(iterations=40)).run(DiffuseInputs(depth=noisy, boundaries=walls), HERE).depth
    away = np.abs(found.value - step)[2:-2, 2:-2]
    away[:, 37] = 0
    assert np.sqrt((away**2).mean()) < 0.1 / 3
    free = Diffuse(Steps(iterations=40)).run(DiffuseInputs(depth=noisy), HERE).depth.value
    assert free[5:-5, 38].mean() > 10.3 > found.value[5:-5, 38].mean() + 0.1


def test_diffusion_keeps_planes_and_fills_regions():
    """A plane is a fixed point, up to walls and borders; a hole fills from its own side alone."""
    y, x = np.mgrid[:40, :60].astype(np.float32)
    plane = 10 + 0.1 * x + 0.05 * y
    walls = np.zeros(plane.shape, bool)
    walls[:, 30] = True
    found = Diffuse(Steps(iterations=50)).run(DiffuseInputs(depth=plane, boundaries=walls), HERE).depth.value
    assert np.abs(found - plane).max() < 1e-4
    depth = np.where(x < 30, 10, 20).astype(np.float32)
    depth[10:20, 20:40] = np.nan
    found = Diffuse(Steps(iterations=50)).run(DiffuseInputs(depth=depth, boundaries=walls), HERE).depth
    assert np.allclose(found.value[10:20, 20:30], 10)
    assert np.allclose(found.value[10:20, 31:40], 20)
    assert np.isnan(found.value[10:20, 30]).all()
    assert found.reliability[15, 25] < found.reliability[5, 25]


def test_brightness_evens_the_noise_out():
    """Noise that grows with the root of intensity is evened out by a root; steady noise leaves all linear."""
    from visint_grouping.brightness import graded

    rng = np.random.default_rng(7)
    ramp = np.linspace(0.05, 0.9, 256)[None].repeat(256, 0)
    steady = graded((ramp + rng.normal(0, 0.02, ramp.shape)).astype(np.float32))
    assert np.isclose(steady.noise, 5.1, rtol=0.1)
    assert np.isclose(steady.levels.max(), 255 * (ramp + 0.07).max(), rtol=0.1)
    shot = graded((ramp + rng.normal(0, 0.03, ramp.shape) * np.sqrt(ramp)).clip(0, 1).astype(np.float32))
    spread = [np.std(np.diff(shot.levels[:, c], axis=0)) for c in (slice(20, 60), slice(190, 230))]
    assert 0.8 < spread[0] / spread[1] < 1.25
