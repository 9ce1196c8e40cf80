"""``shading.albedo``: how bright a surface is that faces the light."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence, Image, Mask
from visint.module import Context, Module, Params, Ports
from visint_shading.lighting.rays import cosines
from visint_shading.photometry import Photometry, ShadingInputs, photometry_of, window_of
from visint_shading.reflectance.several import several_albedos

__all__ = ["AlbedoOf"]


class AlbedoParams(Params):
    """Parameters of ``shading.albedo``.

    Parameters
    ----------
    window
        Over how many full-size pixels (a fortieth of the width if not given) the map's slopes are evened before
        brightness is held against them.
    """

    window: float | None = Field(default=None, gt=0)


class AlbedoOutputs(Ports):
    """Albedo, one a region, 0 unknown.

    ``reliability``: how well one albedo explains the region. ``several``: regions that hold more than one.
    """

    albedo: Image[Array, "H W"]
    reliability: Confidence[Array, "H W"]
    several: Mask[Array, "H W"]


class AlbedoOf(Module[AlbedoParams, ShadingInputs, AlbedoOutputs]):
    """Piecewise constant albedo: one number a region.

    The 99th percentile of a region's even brightness where the map says that the brightest pixels face the
    light (section 4.2, C(iii), in its corrected reading: the average is off by far); else robust regression of
    brightness on the map's cosine of incidence. An ``albedo`` that comes in is averaged over regions.

    Assumes Lambertian surfaces and regions of one albedo. A region whose brightness over cosine falls into two
    clear groups is reported in ``several``; its one number is then worth nothing.
    """

    name = "albedo"
    assumptions = ("lambertian_reflectance", "piecewise_constant_albedo", "perfect_segmentation")

    def run(self, inputs: ShadingInputs, ctx: Context) -> AlbedoOutputs:
        """Albedo of the image's size."""
        found = photometry_of(inputs, window_of(self.params.window, inputs.image, ctx.scale))
        ctx.check()
        labels = found.seen.labels
        many = several_albedos(found.seen.even, _shade(found), labels)
        ctx.measure("regions of several albedos", float(many.sum()))
        ctx.assumed("piecewise_constant_albedo", ~many, labels)
        sure = np.where(many, 0, np.maximum(found.trust, 0))
        return AlbedoOutputs(
            albedo=np.clip(found.albedo.value, 0, 1e6).astype(np.float32)[labels] * (labels > 0),
            reliability=(sure.astype(np.float32)[labels] * (labels > 0)).astype(np.float32),
            several=many[labels] & (labels > 0),
        )


def _shade(found: Photometry) -> Array:
    """The map's cosine of incidence; 1 where it is not known."""
    if found.orientation is None or found.light is None:
        return np.ones(found.seen.labels.shape, np.float32)
    return np.nan_to_num(cosines(found.orientation.normals, found.light))
