"""Rendering: a scene as a stereo pair with its camera, its light and its truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visint.arrays import Array
from visint.errors import UsageError
from visint.fields import Camera, Light
from visint_lab.rays.rig import Pinhole, Rig
from visint_lab.rays.scene import Grain, Scene
from visint_lab.render.packing import Packed, pack
from visint_lab.render.probing import Prober, Sight
from visint_lab.render.truth import Truth

__all__ = ["Rendering", "paint", "render"]


@dataclass(frozen=True, eq=False)
class Rendering:
    """A rendered rectified pair.

    ``left`` and ``right`` are float32 (H, W), linear, in [0, 1]; ``camera`` and ``light`` are in the left
    camera's frame.
    """

    scene: Scene
    left: Array
    right: Array
    camera: Camera
    light: Light
    truth: Truth


def render(scene: Scene, samples: int = 3, seed: int = 0) -> Rendering:
    """``scene`` seen by its rig, rectified first if its cameras converge.

    Parameters
    ----------
    samples
        Rays a pixel along each side: 1 is jagged, 3 is smooth, cost grows with the square.
    seed
        Of the noise; the truth does not depend on it.

    Raises
    ------
    UsageError
        If the scene is empty or out of sight.
    """
    rig = scene.rig.rectified()
    packed = pack(scene)
    left = Prober(scene, rig.left, rig.right, packed)
    right = Prober(scene, rig.right, rig.left, packed)
    truth = _truth(rig, left, right)
    rng = np.random.default_rng(seed)
    seen, beside = (
        _grained(paint(scene, view, samples, packed), scene.grain, rng) for view in (rig.left, rig.right)
    )
    return Rendering(scene, seen, beside, rig.camera(_search_range(truth)), _light(scene, rig.left), truth)


def paint(scene: Scene, view: Pinhole, samples: int = 3, packed: Packed | None = None) -> NDArray[np.float64]:
    """The brightness (H, W) that ``view`` sees, without noise, each pixel the mean of samples² rays."""
    from visint_lab.render import _kernels

    image = np.empty((view.height, view.width))
    lamp = scene.lamp.numbers(scene.background)
    packed = packed if packed is not None else pack(scene)
    _kernels.paint(packed, lamp, view.eye, view.aim, samples, image)
    return image


def _grained(image: NDArray[np.float64], grain: Grain, rng: np.random.Generator) -> Array:
    if grain.multiplicative:
        image = image * (1 + grain.multiplicative * rng.standard_normal(image.shape))
    if grain.additive:
        image = image + grain.additive * rng.standard_normal(image.shape)
    return np.clip(image, 0.0, 1.0).astype(np.float32)


def _light(scene: Scene, view: Pinhole) -> Light:
    vector = np.asarray(scene.lamp.vector, dtype=np.float64)
    axes = np.asarray(view.rotation)
    if scene.lamp.place == "distant":
        return Light.distant(*(axes @ vector))
    return Light.at(*(axes @ (vector - view.eye)))


def _truth(rig: Rig, left: Prober, right: Prober) -> Truth:
    from visint_lab.render.edges import edge_map
    from visint_lab.render.regions import smooth_regions

    here, there = left.whole(), right.whole()
    if not (here.thing >= 0).any():
        raise UsageError.of("VI305", "the left camera sees nothing of the scene")
    disparity, visible = _matched(rig, here, rig.left, -1)
    disparity_right, visible_right = _matched(rig, there, rig.right, +1)
    return Truth(
        depth=here.depth.astype(np.float32),
        depth_right=there.depth.astype(np.float32),
        normals=np.where(here.thing[..., None] < 0, np.nan, here.normals).astype(np.float32),
        disparity=disparity,
        disparity_right=disparity_right,
        visible=visible,
        visible_right=visible_right,
        foreground=here.thing >= 0,
        regions=smooth_regions(here),
        albedo=here.albedo.astype(np.float32),
        lit=here.lit,
        edges=edge_map(left, here),
    )


def _matched(rig: Rig, sight: Sight, view: Pinhole, sign: int) -> tuple[Array, NDArray[np.bool_]]:
    """Disparity, and whether the match lies in sight and inside the other image."""
    shift = rig.right.cx - rig.left.cx
    disparity = view.focal_length * rig.baseline / sight.depth - shift
    column = np.arange(view.width) + sign * disparity
    inside = (column >= 0) & (column <= view.width - 1)
    return disparity.astype(np.float32), sight.seen & inside


def _search_range(truth: Truth) -> tuple[float, float]:
    """A tenth wider than the truth on both sides, and whole pixels: what a careful user would give."""
    known = truth.disparity[np.isfinite(truth.disparity)].astype(np.float64)
    low, high = float(known.min()), float(known.max())
    margin = 1 + 0.1 * (high - low)
    return float(np.floor(low - margin)), float(np.ceil(high + margin))
