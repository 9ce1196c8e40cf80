"""What a boundary is in the scene: the values of a ``BoundaryKinds`` map, from the most significant on."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["BoundaryKind"]


class BoundaryKind(IntEnum):
    """The kinds of boundary; going down a level the smallest but ``NONE`` of a block is kept."""

    NONE = 0
    """No boundary, or one whose kind is not known."""
    LIMB = 1
    """A smooth surface turns away from the viewer: depth jumps, and normals turn across the line of sight."""
    OCCLUDING = 2
    """A sharp edge in front of another surface: depth jumps."""
    CONVEX = 3
    """A crease that points to the viewer: depth is continuous, both faces are seen."""
    CONCAVE = 4
    """A crease that points away from the viewer."""
    MARK = 5
    """A mark, a shadow or a change of albedo on one smooth surface: no change of shape."""
