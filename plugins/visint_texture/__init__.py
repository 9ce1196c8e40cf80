"""Shape from texture: local spectral moments, texture regions, and normals after Super and Bovik (1995)."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_texture.moments import Moments
    from visint_texture.regions import TextureRegions
    from visint_texture.super_bovik import SuperBovik

    return [Moments, SuperBovik, TextureRegions]
