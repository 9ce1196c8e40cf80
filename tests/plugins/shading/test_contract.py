"""Each module of the plugin keeps the contract."""

from __future__ import annotations

from visint.testing import ModuleContract
from visint_shading.albedo import AlbedoOf
from visint_shading.incidence import IncidenceOf
from visint_shading.light import LightOf
from visint_shading.oliensis_dupuis import OliensisDupuis
from visint_shading.slope import Slope
from visint_shading.specular import Specular


class TestAlbedo(ModuleContract):
    module = AlbedoOf


class TestIncidence(ModuleContract):
    module = IncidenceOf


class TestLight(ModuleContract):
    module = LightOf


class TestOliensisDupuis(ModuleContract):
    module = OliensisDupuis


class TestSlope(ModuleContract):
    module = Slope


class TestSpecular(ModuleContract):
    module = Specular
