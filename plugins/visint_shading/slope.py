"""``shading.slope``: normals whose direction is the map's and whose slope is brightness's."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array
from visint.fields import NormalsEvidence
from visint.module import Context, Module, Params, Ports
from visint_shading.photometry import ShadingInputs, photometry_in_frame, window_of
from visint_shading.premises import PREMISES, tell
from visint_shading.surface.cone import onto_cone

__all__ = ["Slope", "angle_error"]


class SlopeParams(Params):
    """Parameters of ``shading.slope``.

    Parameters
    ----------
    window
        Over how many full-size pixels (a fortieth of the width if not given) the map's slopes are evened before
        they give a direction. Wider suits noisier depth; narrower follows bends.
    """

    window: float | None = Field(default=None, gt=0)


class SlopeOutputs(Ports):
    """Unit normals facing the camera."""

    normals: NormalsEvidence


class Slope(Module[SlopeParams, ShadingInputs, SlopeOutputs]):
    """Normals: how steep from brightness, in which direction from the map.

    Brightness leaves a cone of normals around the light (E = η n·l, section 5.2.3); of these the one nearest to
    the map's is taken. So saddles and tori work, where starting from singular points needs to know
    what is convex; and where the map is wrong about direction, the result is too.

    Assumes Lambertian surfaces, one albedo a region, one light and a map that is roughly right: without depth
    or normals nothing is said.
    """

    name = "slope"
    assumptions = PREMISES

    def run(self, inputs: ShadingInputs, ctx: Context) -> SlopeOutputs:
        """Normals of the image's size."""
        found = photometry_in_frame(inputs, window_of(self.params.window, inputs.image, ctx.scale))
        ctx.check()
        tell(found, ctx)
        if found.orientation is None or found.light is None:
            return SlopeOutputs(normals=_silence(inputs.image.shape))
        normals, clear = onto_cone(found.orientation.normals, found.light, found.incidence)
        sigma = np.sqrt(angle_error(found.incidence, found.sigma) ** 2 + _astray(found.incidence, clear) ** 2)
        ctx.measure("mean reliability", float(found.reliability.sum() / inputs.image.size))
        return SlopeOutputs(normals=found.frame.evidence(NormalsEvidence, normals, sigma, found.reliability))


def _silence(shape: tuple[int, ...]) -> NormalsEvidence:
    return NormalsEvidence.of(np.full((*shape, 3), np.nan, np.float32), 1.0, 0.0)


def angle_error(cosine: Array, sigma: Array) -> Array:
    """Standard error of the angle to the light, radians: σ/sin i, bounded by √(2σ) where the light is faced."""
    sine = np.sqrt(np.maximum(1 - cosine * cosine, 1e-6))
    return np.asarray(np.minimum(sigma / sine, np.sqrt(2 * sigma)))


def _astray(cosine: Array, clear: Array) -> Array:
    """What a map that errs by 0.06 rad makes of the direction, times how far the normal leans."""
    sine = np.sqrt(np.maximum(1 - cosine * cosine, 0))
    return np.asarray(sine * np.minimum(0.06 / np.maximum(clear, 1e-3), 1.0))
