"""``shading.light``: where the light is, where nobody says."""

from __future__ import annotations

import math

from pydantic import Field

from visint.fields import Light
from visint.module import Context, Module, Params, Ports
from visint_shading.photometry import ShadingInputs, estimated_light, window_of

__all__ = ["LightOf"]


class LightParams(Params):
    """Parameters of ``shading.light``.

    Parameters
    ----------
    window
        Over how many full-size pixels (a fortieth of the width if not given) the map's slopes are evened.
        Narrow windows leave noise in the normals, which pulls the light towards the line of sight; wide ones
        flatten bends, which pulls it away.
    least
        From which trust on a light is given out; below it the light stays unknown.
    """

    window: float | None = Field(default=None, gt=0)
    least: float = Field(default=0.1, ge=0, le=1)


class LightOutputs(Ports):
    """The light; ``ambient`` in parts of albedo; ``sigma``, its standard error in radians (π where there is
    none); ``reliability`` in [0, 1]. A light that is given comes out as it is.
    """

    light: Light
    ambient: float
    sigma: float
    reliability: float


class LightOf(Module[LightParams, ShadingInputs, LightOutputs]):
    """Direction of one distant light, and how much light comes from everywhere.

    E = ρ (a + n·l) with one albedo ρ a region, fitted to brightness and the map's normals by alternating robust
    least squares; the ambient part is kept only where it explains much more. The standard error is the
    jackknife's over eight parts of the view, and what the fit leaves open where normals lie in a plane.

    Assumes Lambertian surfaces, one albedo a region, one distant light. Brightness that does not follow the
    normals gives no light: reliability 0 and ``Light.unknown()``.
    """

    name = "light"
    assumptions = (
        "lambertian_reflectance",
        "piecewise_constant_albedo",
        "single_light_source",
        "distant_light",
    )

    def run(self, inputs: ShadingInputs, ctx: Context) -> LightOutputs:
        """The light of the reference view."""
        fit = estimated_light(inputs, window_of(self.params.window, inputs.image, ctx.scale))
        ctx.check()
        if fit is None or fit.trust <= self.params.least:
            ctx.assumed("single_light_source", held=False)
            return LightOutputs(light=Light.unknown(), ambient=0.0, sigma=math.pi, reliability=0.0)
        ctx.assumed("single_light_source", held=True)
        ctx.measure("standard error", fit.sigma)
        return LightOutputs(light=fit.light, ambient=fit.ambient, sigma=fit.sigma, reliability=fit.trust)
