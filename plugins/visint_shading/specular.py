"""``shading.specular``: highlights, found to be left out."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Color, Disparity, Image, Mask
from visint.module import Context, Module, Params, Ports
from visint_shading.brightness.seen import SATURATED
from visint_shading.lighting.rays import cosines
from visint_shading.photometry import Photometry, ShadingInputs, photometry_of, window_of
from visint_shading.reflectance.albedo import percentile_by_region
from visint_shading.reflectance.colour import paler_than_region
from visint_shading.reflectance.lobe import lobe_of
from visint_shading.reflectance.mirrored import mirrored
from visint_shading.reflectance.two_views import brighter_than_right

__all__ = ["Specular"]


class SpecularParams(Params):
    """Parameters of ``shading.specular``.

    Parameters
    ----------
    window
        Over how many full-size pixels (a fortieth of the width if not given) the map's slopes are evened.
    faintest
        From which part of the brightness a lobe counts as a highlight. Less masks more of it.
    margin
        By how many full-size pixels what is found is widened.
    """

    window: float | None = Field(default=None, gt=0)
    faintest: float = Field(default=0.1, gt=0, lt=1)
    margin: float = Field(default=2.0, ge=0)


class SpecularInputs(ShadingInputs):
    """As for all of shading; and the right view with the map's disparity, and colour, where there are any."""

    right: Image[Array, "H W"] | None = None
    disparity: Disparity[Array, "H W"] | None = None
    color: Color[Array, "H W 3"] | None = None


class SpecularOutputs(Ports):
    """Where highlights are, and the brightness of their lobes where a lobe was fitted (else 0)."""

    highlights: Mask[Array, "H W"]
    lobe: Image[Array, "H W"]


class Specular(Module[SpecularParams, SpecularInputs, SpecularOutputs]):
    """Highlights by four signs: saturation, a lobe around the mirrored light, two views, and colour.

    E = ρ n·l + g (r·v)^k (section 3.2) fitted a region: what the lobe adds. Brightness that does not stay with
    its point from one view to the other. Pixels paler than their region (dichromatic reflectance). Each sign is
    looked for where its inputs are there; a pixel with any of them is masked.

    Assumes one albedo and one gloss a region, one light, and a map that is roughly right for the lobe and the
    two views. Where stereo followed the highlight itself, neither sees it.
    """

    name = "specular"
    assumptions = (
        "lambertian_reflectance",
        "piecewise_constant_albedo",
        "single_light_source",
        "dichromatic_reflectance",
    )

    def run(self, inputs: SpecularInputs, ctx: Context) -> SpecularOutputs:
        """Mask and lobe of the image's size."""
        found = photometry_of(inputs, window_of(self.params.window, inputs.image, ctx.scale))
        ctx.check()
        lobe = _lobe(found)
        signs = self._signs(inputs, found, lobe)
        for name, where in signs.items():
            ctx.measure(f"{name} share", float(where.mean()))
        highlights = np.logical_or.reduce(list(signs.values()))
        _tell(highlights, found.seen.labels, ctx)
        return SpecularOutputs(highlights=_widened(highlights, self.params.margin / ctx.scale), lobe=lobe)

    def _signs(self, inputs: SpecularInputs, found: Photometry, lobe: Array) -> dict[str, Array]:
        even = np.nan_to_num(found.seen.even)
        signs = {
            "saturated": np.nan_to_num(inputs.image) >= SATURATED,
            "lobe": (lobe > self.params.faintest * even) & (lobe > 0),
        }
        if inputs.right is not None and inputs.disparity is not None:
            moved = brighter_than_right(inputs.image, inputs.right, inputs.disparity, found.seen.noise)
            signs["two views"] = moved & _bright_inside(found)
        if inputs.color is not None:
            signs["colour"] = paler_than_region(inputs.color, found.seen.labels)
        return signs


def _lobe(found: Photometry) -> Array:
    if found.orientation is None or found.light is None:
        return np.zeros(found.seen.labels.shape, np.float32)
    normals = found.orientation.normals
    cosine = np.nan_to_num(cosines(normals, found.light))
    mirror = mirrored(normals, found.light, found.camera)
    return np.clip(lobe_of(found.seen.even, cosine, mirror, found.seen.labels), 0, 1)


def _bright_inside(found: Photometry) -> Array:
    """Brighter than most of its region, and not at its edge, where the other view may see something else."""
    import cv2

    labels, even = found.seen.labels, np.nan_to_num(found.seen.even)
    usual = percentile_by_region(np.clip(even, 0, 1), labels, 0.6)
    inner = cv2.erode((labels > 0).astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    return np.asarray(inner & (even > usual[labels]))


def _widened(mask: Array, margin: float) -> Array:
    import cv2

    side = 2 * round(margin) + 1
    return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)) > 0)


def _tell(highlights: Array, labels: Array, ctx: Context) -> None:
    """Lambertian reflectance is violated in a region a hundredth of which is highlight."""
    count = int(labels.max(initial=0)) + 1
    share = np.bincount(labels.ravel(), highlights.ravel(), minlength=count)
    ctx.assumed("lambertian_reflectance", share < 0.01 * np.bincount(labels.ravel(), minlength=count), labels)
