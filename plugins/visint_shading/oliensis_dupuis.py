"""``shading.oliensis_dupuis``: relief and normals from the points that face the light outwards."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, Mask
from visint.fields import NormalsEvidence, ReliefEvidence
from visint.module import Context, Module, Params, Ports
from visint_shading.heights.relief import Relief, relief_of
from visint_shading.lighting.rays import cosines
from visint_shading.photometry import Photometry, ShadingInputs, photometry_in_frame, window_of
from visint_shading.premises import PREMISES, tell
from visint_shading.slope import angle_error

__all__ = ["OliensisDupuis"]


class OliensisDupuisParams(Params):
    """Parameters of ``shading.oliensis_dupuis``.

    Parameters
    ----------
    window
        Over how many full-size pixels (a fortieth of the width if not given) the map's slopes are evened before
        it is asked how a surface bends.
    otherwise
        How a surface bends at singular points of which the map knows nothing.
    """

    window: float | None = Field(default=None, gt=0)
    otherwise: Literal["convex", "concave"] = "convex"


class OliensisDupuisOutputs(Ports):
    """Relief (depth but for scale; of the map's scale where it has depth), normals, and the singular points."""

    relief: ReliefEvidence
    normals: NormalsEvidence
    singular: Mask[Array, "H W"]


class OliensisDupuis(Module[OliensisDupuisParams, ShadingInputs, OliensisDupuisOutputs]):
    """Relief from singular points outwards: from where a surface faces the light, at least cost to every pixel.

    J. Oliensis and P. Dupuis, Direct method for reconstructing shape from shading, CVPR 1992,
    doi:10.1109/CVPR.1992.223155. Each region for itself (section 4.1.1): the map's depth gives the height of
    each singular point and says whether the surface is convex or concave there; nothing is carried across a
    boundary. The eikonal equation is that of a pinhole camera and of a light behind it, an oblique or a near
    one; solved by fast sweeping.

    Assumes Lambertian surfaces, one albedo a region, one light, and that every way up or down ends at a
    singular point that is convex or concave. Saddles do not start anything. A region without a singular point,
    or whose result the map contradicts, gets no reliability.
    """

    name = "oliensis_dupuis"
    assumptions = (*PREMISES, "smoothness")

    def run(self, inputs: ShadingInputs, ctx: Context) -> OliensisDupuisOutputs:
        """Relief and normals of the image's size."""
        window = window_of(self.params.window, inputs.image, ctx.scale)
        found = photometry_in_frame(inputs, window)
        ctx.check()
        tell(found, ctx)
        light = found.source
        if light is None:
            return _silence(inputs.image.shape)
        otherwise = 1 if self.params.otherwise == "convex" else -1
        depth = None if inputs.depth is None else found.frame.part(inputs.depth)
        relief = relief_of(found, light, depth, otherwise, 2.5 * window)
        ctx.measure("singular points", float(relief.singular.bend.size - 1))
        ctx.measure("saddles", float((relief.singular.bend[1:] == 0).sum()))
        return _answer(found, relief)


def _silence(shape: tuple[int, ...]) -> OliensisDupuisOutputs:
    nothing = np.full((*shape, 3), np.nan, np.float32)
    return OliensisDupuisOutputs(
        relief=ReliefEvidence.of(nothing[..., 0], 1.0, 0.0),
        normals=NormalsEvidence.of(nothing, 1.0, 0.0),
        singular=np.zeros(shape, bool),
    )


def _answer(found: Photometry, relief: Relief) -> OliensisDupuisOutputs:
    labels = found.seen.labels
    apart = _apart(found, relief)
    agreed = _agreed(apart, labels, found.trust.size)
    sigma = angle_error(found.incidence, found.sigma) + 0.05 + 0.5 * apart
    known = relief.depth[np.isfinite(relief.depth)]
    above = np.abs(relief.depth - (np.median(known) if known.size else 0))
    whole = found.frame
    return OliensisDupuisOutputs(
        relief=whole.evidence(
            ReliefEvidence,
            relief.depth,
            0.01 * np.abs(relief.depth) + 0.1 * above,
            agreed * found.trust[labels] * (labels > 0),
        ),
        normals=whole.evidence(NormalsEvidence, relief.normals, sigma, agreed * found.reliability),
        singular=whole.whole(relief.singular.group > 0),
    )


def _apart(found: Photometry, relief: Relief) -> Array:
    """Angle (H, W) between the relief's normals and the map's; 0 where there is no map, NaN where no relief."""
    if found.orientation is None:
        return np.where(np.isfinite(relief.normals[..., 2]), 0, np.nan)
    cosine = cosines(relief.normals, found.orientation.normals)
    return np.asarray(np.arccos(np.clip(cosine, -1, 1)))


def _agreed(apart: Array, labels: Array, count: int) -> Array:
    """In [0, 1]: less where a normal lies 12° from the map's, or a region's in the mean; 0 from 30° and 25°.

    Where ways from several points meet, some pixels are wrong and their neighbours right.
    """
    there = (labels > 0) & np.isfinite(apart)
    members = np.bincount(labels[there], minlength=count)
    mean = np.bincount(labels[there], apart[there], minlength=count) / np.maximum(members, 1)
    region = np.clip((0.44 - mean) / 0.23, 0, 1) * (members > 0)
    return np.asarray(np.clip((0.52 - np.nan_to_num(apart, nan=1.0)) / 0.31, 0, 1) * region[labels])
