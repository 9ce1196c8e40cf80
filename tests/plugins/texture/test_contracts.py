"""The texture modules are held to the contract of every module."""

from __future__ import annotations

from typing import ClassVar

from visint.testing import ModuleContract
from visint_texture.moments import Moments
from visint_texture.regions import TextureRegions
from visint_texture.super_bovik import SuperBovik


class TestMoments(ModuleContract):
    module: ClassVar = Moments


class TestRegions(ModuleContract):
    module: ClassVar = TextureRegions


class TestSuperBovik(ModuleContract):
    size = (96, 120)  # room for the sites of a patch

    module: ClassVar = SuperBovik
