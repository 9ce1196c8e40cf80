"""``shading.incidence``: the angle to the light that brightness stands for."""

from __future__ import annotations

from pydantic import Field

from visint.fields import IncidenceEvidence
from visint.module import Context, Module, Params, Ports
from visint_shading.photometry import ShadingInputs, photometry_in_frame, window_of
from visint_shading.premises import PREMISES, tell

__all__ = ["IncidenceOf"]


class IncidenceParams(Params):
    """Parameters of ``shading.incidence``.

    Parameters
    ----------
    window
        Over how many full-size pixels (a fortieth of the width if not given) the map's slopes are evened before
        brightness is held against them. Wider suits noisier depth; narrower keeps bends.
    """

    window: float | None = Field(default=None, gt=0)


class IncidenceOutputs(Ports):
    """Cosine of the angle between normal and light."""

    incidence: IncidenceEvidence


class IncidenceOf(Module[IncidenceParams, ShadingInputs, IncidenceOutputs]):
    """What brightness says as such: brightness / albedo, the cosine of incidence on a Lambertian surface.

    The image irradiance equation E = η n·l (section 5.2.3), with one albedo a region and one light. Nothing is
    said about the direction in which a surface turns from the light.

    Assumes Lambertian surfaces, one albedo a region, one light and no light from other surfaces. Reliability is
    near 1 only where the map's surface confirms all that: 0 in shadow, on highlights, on textured regions,
    where brightness does not follow the map's normals, and where the surface faces the light, since there a
    slope hardly changes brightness.
    """

    name = "incidence"
    assumptions = PREMISES

    def run(self, inputs: ShadingInputs, ctx: Context) -> IncidenceOutputs:
        """Incidence of the image's size."""
        found = photometry_in_frame(inputs, window_of(self.params.window, inputs.image, ctx.scale))
        ctx.check()
        tell(found, ctx)
        ctx.measure("mean reliability", float(found.reliability.sum() / inputs.image.size))
        evidence = found.frame.evidence(IncidenceEvidence, found.incidence, found.sigma, found.reliability)
        return IncidenceOutputs(incidence=evidence)
