"""Depth, disparity and normals where any one of them and a camera are known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from visint.fields import geometry
from visint.fields.camera import Camera
from visint.fields.evidence import DepthEvidence, DisparityEvidence

__all__ = ["derived"]


def derived(values: Mapping[str, tuple[str, Any]], camera: Camera | None) -> dict[str, tuple[str, Any, str]]:
    """The missing ones of disparity, depth and normals.

    Parameters
    ----------
    values
        Output name → (kind, value); values are arrays or evidence.
    camera
        The camera of these maps; without one, or from maps of another size, nothing follows.

    Returns
    -------
    Name → (kind, value, the output it follows from). Names already taken are left alone.
    """
    if camera is None:
        return {}
    origin = _origin(values)
    if origin is None:
        return {}
    if _plain(values[origin][1]).shape != camera.size:
        return {}
    depth, disparity = _both(*values[origin], camera)
    found = {
        "disparity": ("Disparity", disparity, origin),
        "depth": ("Depth", depth, origin),
        "normals": ("Normals", geometry.normals_from_depth(_plain(depth), camera), origin),
    }
    kinds = {kind for kind, _ in values.values()}
    return {name: given for name, given in found.items() if name not in values and given[0] not in kinds}


def _origin(values: Mapping[str, tuple[str, Any]]) -> str | None:
    for wanted in ("Depth", "Disparity"):
        for name, (kind, value) in values.items():
            if kind == wanted and value is not None:
                return name
    return None


def _both(kind: str, value: Any, camera: Camera) -> tuple[Any, Any]:
    """(depth, disparity), as evidence where the one given is evidence."""
    if isinstance(value, DepthEvidence):
        return value, geometry.disparity_evidence(value, camera)
    if isinstance(value, DisparityEvidence):
        return geometry.depth_evidence(value, camera), value
    if kind == "Depth":
        return value, geometry.disparity_from_depth(value, camera)
    return geometry.depth_from_disparity(value, camera), value


def _plain(value: Any) -> Any:
    return getattr(value, "value", value)
