"""Each module of the plugin keeps the contract."""

from __future__ import annotations

from visint.testing import ModuleContract
from visint_shading.albedo import AlbedoOf
from visint_shading.incidence import IncidenceOf


class TestAlbedo(ModuleContract):
    module = AlbedoOf


class TestIncidence(ModuleContract):
    module = IncidenceOf
