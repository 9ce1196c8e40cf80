"""All that brightness says before a direction is chosen: what every module of the plugin starts from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array, Boundaries, Confidence, Depth, Image, Mask, Normals, Regions
from visint.fields import Camera, Light
from visint.module import Ports
from visint_shading.brightness.frame import Frame, frame_of
from visint_shading.brightness.seen import Seen, seen
from visint_shading.lighting.estimate import LightFit, estimated
from visint_shading.lighting.rays import cosines, light_directions, usual_depth
from visint_shading.reflectance.albedo import Albedo, albedo_by_region, given_by_region
from visint_shading.reflectance.judgement import Agreement, agreement_of, trust_of
from visint_shading.surface.flat import flat_regions, with_planes
from visint_shading.surface.orientation import Orientation, from_depth, from_normals

__all__ = [
    "Photometry",
    "ShadingInputs",
    "estimated_light",
    "photometry_in_frame",
    "photometry_of",
    "window_of",
]

UNTESTED = 0.3
"""Trust where there is no surface to hold brightness against."""


class ShadingInputs(Ports):
    """A view, the map so far, and what is known of light and surfaces.

    ``depth`` and its confidence (or else ``normals``) say how surfaces are turned; ``regions`` (or else
    ``boundaries``) where one albedo ends. An unknown ``light`` is estimated from both; without a ``camera`` 53°
    of view. ``albedo`` (NaN or 0 unknown), ``ambient`` (in parts of albedo) and ``highlights`` may come from
    other modules; without them the first two are estimated and only what is saturated is left out.
    """

    image: Image[Array, "H W"]
    depth: Depth[Array, "H W"] | None = None
    depth_confidence: Confidence[Array, "H W"] | None = None
    normals: Normals[Array, "H W 3"] | None = None
    regions: Regions[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    light: Light | None = None
    camera: Camera | None = None
    albedo: Image[Array, "H W"] | None = None
    ambient: float | None = None
    highlights: Mask[Array, "H W"] | None = None


class Photometry(NamedTuple):
    """What brightness says, pixel by pixel and region by region.

    All arrays (H, W) and ``camera`` are those of ``frame``, the part of the image looked at. ``orientation`` is
    the map's surface, ``source`` the light and ``light`` unit vectors to it, (3,) or (H, W, 3); None if not
    known. ``distance`` is how far surfaces usually are. ``incidence`` is what brightness makes of it, NaN where
    it says nothing, with ``sigma`` and ``reliability``, float32 (H, W). ``trust`` is by label.
    """

    frame: Frame
    camera: Camera
    seen: Seen
    orientation: Orientation | None
    source: Light | None
    light: Array | None
    light_trust: float
    distance: float
    albedo: Albedo
    agreement: Agreement | None
    trust: Array
    incidence: Array
    sigma: Array
    reliability: Array


def photometry_of(inputs: ShadingInputs, window: float) -> Photometry:
    """Albedo, incidence and trust of ``inputs``; ``window`` is that of the map's normals, pixels."""
    view, window = _view(inputs, window)
    return _photometry(inputs, view, window, Frame.around(inputs.image.shape))


def photometry_in_frame(inputs: ShadingInputs, window: float) -> Photometry:
    """The same of the smallest box that holds all regions: around it brightness says nothing."""
    view, window = _view(inputs, window)
    frame = frame_of(view.labels)
    part = view._replace(labels=frame.part(view.labels), even=frame.part(view.even))
    return _photometry(inputs, part, window, frame)


def _photometry(whole: ShadingInputs, view: Seen, window: float, frame: Frame) -> Photometry:
    inputs = _part(whole, frame)
    camera = _camera(inputs)
    surface = _surface(inputs, view, camera, window)
    fit = _light(inputs, view, surface)
    distance, directions = _directions(whole, inputs, fit)
    ambient = inputs.ambient if inputs.ambient is not None else (fit.ambient if fit else 0.0)
    cosine = None
    if surface is not None and directions is not None:
        cosine = cosines(surface.normals, directions)
    albedo = _albedo(inputs.albedo, view, cosine, ambient)
    found = None
    if cosine is not None:
        found = agreement_of(view.even, view.spread, view.labels, cosine, ambient, window)
    trust = _trust(found, albedo, fit)
    return Photometry(
        frame,
        camera,
        view,
        surface,
        fit.light if fit else None,
        directions,
        fit.trust if fit else 0.0,
        distance,
        albedo,
        found,
        trust,
        *_incidence(view, albedo, ambient, trust),
    )


def _part(whole: ShadingInputs, frame: Frame) -> ShadingInputs:
    """What is known of the pixels in ``frame``."""
    arrays = {name: frame.part(value) for name, value in whole if isinstance(value, np.ndarray)}
    return whole.model_copy(update={**arrays, "camera": frame.camera(_camera(whole))})


def _directions(whole: ShadingInputs, part: ShadingInputs, fit: LightFit | None) -> tuple[float, Array | None]:
    """How far surfaces usually are, in the whole view, and unit vectors from those in ``part`` to the light."""
    if fit is None:
        return 0.0, None
    distance = usual_depth(whole.depth, fit.light, _camera(whole))
    return distance, light_directions(fit.light, part.depth, _camera(part), distance)


def window_of(given: float | None, image: Array, scale: int) -> float:
    """The window in pixels of this level, one at least; by default 1/43 of the image's width (6 of 256)."""
    return max(1.0, image.shape[1] * 6 / 256 if given is None else given / scale)


def estimated_light(inputs: ShadingInputs, window: float) -> LightFit | None:
    """The light that is given, or the one that explains the view; None if none does."""
    view, window = _view(inputs, window)
    return _light(inputs, view, _surface(inputs, view, _camera(inputs), window))


def _camera(inputs: ShadingInputs) -> Camera:
    rows, columns = inputs.image.shape
    return inputs.camera or Camera.uncalibrated(columns, rows)


def _view(inputs: ShadingInputs, window: float) -> tuple[Seen, float]:
    """The view, and the window widened with its noise: what is noise here makes stereo noisier still."""
    dull = ~inputs.highlights if inputs.highlights is not None else np.ones(inputs.image.shape, bool)
    view = seen(inputs.image, dull, inputs.regions, inputs.boundaries, window / 6)
    return view, window * (1 + 10 * view.noise)


def _surface(inputs: ShadingInputs, view: Seen, camera: Camera, window: float) -> Orientation | None:
    if inputs.depth is not None:
        surface = from_depth(inputs.depth, inputs.depth_confidence, view.labels, camera, window)
        flat = flat_regions(view.even, view.labels, view.spread)
        return with_planes(surface, inputs.depth, view.labels, flat, camera)
    if inputs.normals is not None:
        return from_normals(inputs.normals, view.labels, window)
    return None


def _light(inputs: ShadingInputs, view: Seen, surface: Orientation | None) -> LightFit | None:
    if inputs.light is not None and inputs.light.place != "unknown":
        return LightFit(inputs.light, 0.0, 0.0, 1.0)
    return None if surface is None else estimated(view, surface)


def _albedo(given: Array | None, view: Seen, cosine: Array | None, ambient: float) -> Albedo:
    if given is not None:
        return given_by_region(given, view.labels)
    return albedo_by_region(view.even, view.labels, cosine, view.spread, ambient)


def _trust(found: Agreement | None, albedo: Albedo, fit: LightFit | None) -> Array:
    if fit is None:
        return np.zeros_like(albedo.value)
    return np.full(albedo.value.size, UNTESTED) if found is None else trust_of(found, albedo.value) * fit.trust


def _incidence(view: Seen, albedo: Albedo, ambient: float, trust: Array) -> tuple[Array, Array, Array]:
    """Cosine of incidence (H, W) from brightness, its sigma and its reliability."""
    labels = np.where(albedo.value[view.labels] > 0, view.labels, 0)
    scale = albedo.value.astype(np.float32)[labels]
    with np.errstate(divide="ignore", invalid="ignore"):
        raw = np.where(labels > 0, view.even / scale - np.float32(ambient), np.float32(np.nan))
        noise = view.spread / scale
    value = np.clip(raw, 0, 1).astype(np.float32)
    error = albedo.error.astype(np.float32)[labels]
    sigma = np.sqrt(noise**2 + (error * value) ** 2 + np.float32(0.01**2))
    sure = trust.astype(np.float32)[labels] * _informs(raw, value)
    return value, sigma.astype(np.float32), np.nan_to_num(sure).astype(np.float32)


def _informs(raw: Array, value: Array) -> Array:
    """Less where a surface faces the light (slopes hardly change brightness), is too bright, or in shadow."""
    facing = np.sqrt(np.maximum(1 - value * value, 0)) / np.float32(0.3)
    shadow = (value - np.float32(0.08)) / np.float32(0.12)
    excess = (np.float32(1.25) - raw) / np.float32(0.15)
    return np.asarray(np.clip(facing, 0, 1) * np.clip(shadow, 0, 1) * np.clip(excess, 0, 1))
