"""From images and a stereo disparity to the setting of the energy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint_bayes.joint.brightness import Brightness
from visint_bayes.joint.cuts import cut_by, near_cuts, patches, standing
from visint_bayes.joint.domain import Domain
from visint_bayes.joint.energy import Recipe, Setting, minimum, slopes_of
from visint_bayes.joint.noise import noise_inside
from visint_bayes.joint.photometry import masked_blur, views_of
from visint_bayes.joint.reflectance import Reflectance, reflectance
from visint_bayes.joint.slant import lighting

__all__ = ["Pair", "blur_for", "brightened", "setting_of", "with_cuts"]

USUAL = 95.0
"""Root of an object's area in pixels, at which the weights of the energy are given."""
MODEL = 0.03
"""n·l is never known better than this: the model's own error."""
TOO_MUCH_SHINE = 0.35
"""Of the object: beyond, highlights are no highlights."""

FIRM, FREE = 0.3, 0.003
"""How firmly what the right view does not see is held to the stereo, px⁻²: freely where one albedo makes
shading worth more there."""
MOST = 6
"""More patches than this are texture, not surfaces."""
REACH = 10.0
"""How far from a depth edge stereo is not believed, px at 256 pixels."""

EXTENDED = Recipe(0.003, 0.3, crease=10.0, turns=3)
"""How a surface is continued to an edge: smoothly, by brightness where there is a light."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A pair before a void: images float32 (H, W), their foregrounds bool, complete disparities of both views.

    ``light`` is None where it is not known or not to be used.
    """

    left: Array
    right: Array
    inside: Array
    inside_right: Array
    stereo: Array
    stereo_right: Array
    camera: Camera
    light: Light | None = None


def blur_for(noise: float) -> float:
    """Standard deviation, px, of the smoothing that noise (parts of full scale) asks for."""
    return float(np.clip(0.6 + 30 * noise, 0.6, 1.8))


def setting_of(pair: Pair) -> tuple[Setting, float]:
    """The setting without shading, and the noise found."""
    from visint_bayes.joint.matching import _kernels

    noise = max(noise_inside(pair.left, pair.inside), noise_inside(pair.right, pair.inside_right))
    masks = (pair.inside, pair.inside_right)
    views = views_of((pair.left, pair.right), masks, noise, max(blur_for(noise), 0.8))
    field = pair.stereo.astype(np.float64)
    there, met, spare = (np.empty_like(field) for _ in range(3))
    _kernels.warp(pair.stereo_right, field, -1.0, there, spare)
    _kernels.warp(views.inside_right, field, -1.0, met, spare)
    gap = np.nan_to_num(np.maximum(there - field, 0)).astype(np.float32)
    hidden = (gap > 1.5) | ~(met > 0.5)
    unseen = np.zeros_like(pair.inside)
    domain = Domain.of(pair.inside)
    zoom = float(np.sqrt(max(pair.inside.sum(), 1)) / USUAL)
    return Setting(domain, views, pair.stereo, gap, hidden, unseen, unseen, pair.camera, None, zoom), noise


def brightened(
    setting: Setting, pair: Pair, noise: float, surface: Array, amplitude: float = 1.0
) -> tuple[Setting, Reflectance | None]:
    """The setting with what brightness says, as ``surface`` explains it; unchanged without a light.

    At an ``amplitude`` of 0 brightness still tells highlights and albedo, and says nothing about slopes.
    """
    if pair.light is None or pair.light.vector is None:
        return setting, None
    blur = blur_for(noise)
    inside = pair.inside.astype(np.float32)
    image = np.nan_to_num(pair.left)
    calm = masked_blur(image, inside, max(blur, 1.2))
    cosine = lighting(surface, slopes_of(setting.domain, surface), pair.camera, pair.light).cosine
    found = reflectance(calm, cosine, pair.inside, noise / (3.54 * blur), setting.zoom)
    albedo = np.concatenate([[np.nan], found.albedo])[found.labels]
    usable = _inner(pair.inside) & ~found.shine
    incidence = np.where(usable, masked_blur(image, inside, blur) / albedo, np.nan).astype(np.float32)
    sigma = np.sqrt((noise / albedo) ** 2 + 4 * np.pi * blur_for(0.03) ** 2 * MODEL**2).astype(np.float32)
    shiny = (
        found.shine if found.shine.sum() < TOO_MUCH_SHINE * pair.inside.sum() else np.zeros_like(found.shine)
    )
    known = Brightness(incidence, sigma / max(amplitude, 1e-6) ** 0.5, pair.light) if amplitude > 0 else None
    hold = FIRM if known is None or len(found.albedo) > 1 else FREE
    return replace(setting, brightness=known, unseen=shiny, hold=hold), found


def with_cuts(setting: Setting, pair: Pair, noise: float, surface: Array) -> tuple[Setting, Array]:
    """The setting cut at depth edges inside the object, where brightness shows them and surfaces confirm them.

    Comes with the surface to go on from: near a cut it continues what lies on its own side of it.
    """
    blur = max(blur_for(noise), 1.0)
    calm = masked_blur(np.nan_to_num(pair.left), pair.inside.astype(np.float32), blur)
    labels = patches(calm, pair.inside, noise / (3.54 * blur), setting.zoom)
    if not 2 <= labels.max() <= MOST:
        return setting, surface
    apart = cut_by(pair.inside, labels)
    near = near_cuts(apart, REACH * setting.zoom)
    blind = replace(setting, domain=apart, adrift=near, unseen=setting.unseen | near)
    tried = minimum(blind, EXTENDED, surface)
    domain = standing(pair.inside, labels, tried, setting.zoom)
    near = near_cuts(domain, REACH * setting.zoom)
    return replace(setting, domain=domain, adrift=near), np.where(near, tried, surface)


def _inner(mask: Array) -> Array:
    """Without the pixels that things and void share."""
    import cv2

    return np.asarray(cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=1) > 0)
