"""Assumptions: the premises on which vision modules rest, by name, each in one sentence.

Names 1 to 32 follow Appendix B of the dissertation, in the field's words; those behind are what stereo,
shading and line labelling rest on besides. A module declares its own in
:attr:`visint.module.Module.assumptions` and says where it found them held or violated with
:meth:`visint.module.Context.assumed`. A plugin may name one that is missing here ``plugin.name``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from visint.names import ModuleId, did_you_mean

__all__ = ["ASSUMPTIONS", "check_names", "meaning"]

ASSUMPTIONS: Mapping[str, str] = MappingProxyType(
    {
        "transparency": "More than one surface may be seen at a pixel: depth has several values.",
        "opacity": "One surface is seen at a pixel: depth has one value.",
        "general_viewpoint": "No alignment in the image is an accident of where the camera stands.",
        "coherence": "Features that one physical cause makes go together: they are near and alike.",
        "cohesiveness": "Objects are compact and opaque.",
        "continuity": "A property changes without jumps along a line of the image or the scene.",
        "isotropy": "In the scene all directions of edges are equally likely.",
        "homogeneity": "One texture covers a surface, the same everywhere on it.",
        "independence": "The directions of neighbouring edge elements are independent.",
        "regularity": "The texture repeats itself; it is not a random one.",
        "regular_projective_geometry": "Texture and viewpoint do not conspire to cancel each other's effect.",
        "smoothness": "A surface has a tangent plane wherever no boundary runs.",
        "integrability": "Slopes or normals are those of a surface: going round a loop ends at the same depth.",
        "local_spatial_interaction": "What is far away in the image says little about a pixel.",
        "lambertian_reflectance": "A surface looks equally bright from everywhere, by the cosine of incidence.",
        "gaussian_noise": "The noise is Gaussian.",
        "perfect_segmentation": "Which pixels belong to the objects looked at is known.",
        "single_light_source": "One source lights everything.",
        "small_motion": "Features move by little from one image to the next.",
        "polyhedral_world": "Objects are solid bodies with plane faces.",
        "paraperspective_projection": "An object is small beside its distance and shrinks as a whole.",
        "sufficient_context": "The markings on a surface show how projection distorts them.",
        "symmetry": "Objects are symmetric.",
        "rigidity": "No part of an object moves against another.",
        "locally_spherical_surface": "At each point a surface bends equally in all directions.",
        "no_interreflection": "Light reaches a surface from the source alone, not from other surfaces.",
        "piecewise_continuity": "Lines in the image are continuous but for a few breaks.",
        "dichromatic_reflectance": "Diffuse light has the surface's colour, highlights have the source's.",
        "fractal_surface": "A fractal describes the shape of the surface.",
        "piecewise_constant_albedo": "Albedo changes at the boundaries of regions only.",
        "constant_albedo": "All surfaces have the same albedo.",
        "gaussian_blur": "The point spread of the camera is a Gaussian.",
        "rectified_views": "Corresponding points lie on the same row of both images.",
        "brightness_constancy": "Corresponding points are equally bright in both images.",
        "distant_light": "The light comes from one direction everywhere.",
        "orthographic_projection": "Lines of sight are parallel over the part looked at.",
        "trihedral_corners": "Three surfaces meet at each corner of a body.",
    }
)
"""Every name without a dot that a module may declare, with what it says."""


def meaning(name: str) -> str:
    """The sentence of an assumption; empty for a plugin's own."""
    return ASSUMPTIONS.get(name, "")


def check_names(names: Iterable[str]) -> None:
    """Refuses names that are neither in the table nor qualified by a plugin, and names given twice.

    Raises
    ------
    ValueError
        Naming the one that is wrong and the nearest that there is.
    TypeError
        If ``names`` is one name and not several, or one of them is no text.
    """
    if isinstance(names, str) or not all(isinstance(name, str) for name in names):
        raise TypeError(f"assumptions must be a tuple of names, not {names!r}")
    seen: set[str] = set()
    for name in names:
        if name not in ASSUMPTIONS and ModuleId.parse(name) is None:
            near = did_you_mean(name, ASSUMPTIONS)
            hint = f"did you mean {near!r}?" if near else "a new one is written 'plugin.name'"
            raise ValueError(f"assumption {name!r} is unknown; {hint}")
        if name in seen:
            raise ValueError(f"assumption {name!r} is declared twice")
        seen.add(name)
