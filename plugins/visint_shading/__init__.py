"""Shape from shading: what brightness says of a surface, and how sure it is that its model holds."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_shading.albedo import AlbedoOf
    from visint_shading.incidence import IncidenceOf
    from visint_shading.light import LightOf
    from visint_shading.oliensis_dupuis import OliensisDupuis
    from visint_shading.slope import Slope
    from visint_shading.specular import Specular

    return [AlbedoOf, IncidenceOf, LightOf, OliensisDupuis, Slope, Specular]
