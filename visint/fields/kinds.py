"""Field kinds: one table of what each kind of value is and how it changes with the level.

============= ============== ============ ================ =========== ===========
kind          array          unit         going down       going up    constrains
============= ============== ============ ================ =========== ===========
Image         float32 H W    1            mean             linear
Color         float32 H W 3  1            mean             linear
Features      float32 H W C  1            mean             linear
Depth         float32 H W    baseline     mean of known    linear      depth
Disparity     float32 H W    px           mean, halved     linear, ×2  depth
Relief        float32 H W    1            mean of known    linear      depth
Normals       float32 H W 3  1            mean, unit again linear      depth
Slopes        float32 H W 2  baseline/px  mean, ×2         linear, ½   depth
Incidence     float32 H W    1            mean             linear      depth
Boundaries    bool H W       1            any pixel        nearest     boundaries
BoundaryKinds uint8 H W      1            most significant nearest
Regions       int32 H W      1            most frequent    nearest     boundaries
Mask          bool H W       1            any pixel        nearest
Confidence    float32 H W    1            mean             linear
Sigma         float32 H W    1            mean             linear
Camera        Camera                      halved           doubled
Light         Light                       same             same
Scalars       float64 N      1            same             same
Scalar        float                       same             same
Flag          bool                        same             same
Text          str                         same             same
============= ============== ============ ================ =========== ===========

``between`` of a pyramid may choose ``replicate``, ``linear`` or ``quadratic`` for going up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from visint.arrays import SPECS, Array, ArraySpec, read_only
from visint.fields import resampling as rs
from visint.fields.evidence import Evidence

__all__ = ["KINDS", "FieldKind", "Interpolation", "down", "up"]

Interpolation = Literal["replicate", "linear", "quadratic"]
Size = tuple[int, int]
_UPWARD: Mapping[str, Callable[[Array, Size], Array]] = MappingProxyType(
    {"replicate": rs.nearest_up, "linear": rs.linear_up, "quadratic": rs.quadratic_up}
)


def _same(value: Any) -> Any:
    return value


def _same_up(value: Any, size: Size) -> Any:  # noqa: ARG001 - the form of every rule upwards
    return value


@dataclass(frozen=True, slots=True)
class FieldKind:
    """What a kind of value is and how it goes from level to level.

    Parameters
    ----------
    name
        As written in graph files; a plugin's own is qualified by its entry point: ``"flow.Flow"``.
    array
        Its array spec, or None for a value that is no array.
    down, up
        One level coarser; one level finer, to a given (rows, columns).
    finer
        What values are multiplied by going one level up (2 for disparity, ½ for slopes); 1/finer going down.
    interpolated
        Whether ``between`` may choose how it goes up (labels and lines may not).
    constrains
        The map field that evidence of this kind is about; empty if none.
    """

    name: str
    array: ArraySpec | None = None
    down: Callable[[Any], Any] = _same
    up: Callable[[Any, Size], Any] = _same_up
    finer: float = 1.0
    interpolated: bool = False
    constrains: str = ""

    def downward(self, value: Any) -> Any:
        """``value`` one level coarser; arrays keep their dtype."""
        coarse = self.down(value)
        return self._typed(coarse if self.finer == 1.0 else coarse * np.float32(1 / self.finer))

    def upward(self, value: Any, size: Size, how: Interpolation | None = None) -> Any:
        """``value`` one level finer, of ``size`` (rows, columns); ``how`` overrides the kind's own rule."""
        rule = _UPWARD[how] if how and self.interpolated else self.up
        fine = rule(value, size)
        fine = fine if self.finer == 1.0 else fine * np.float32(self.finer)
        return self._typed(rs.renormalised(fine) if self.name == "Normals" else fine)

    def _typed(self, value: Any) -> Any:
        """The rules calculate in float32; a kind of another dtype gets its own back."""
        return value if self.array is None else value.astype(self.array.dtype, copy=False)


def _continuous(name: str, finer: float = 1.0, constrains: str = "") -> FieldKind:
    return FieldKind(name, SPECS[name], rs.block_mean, rs.linear_up, finer, True, constrains)


def _table() -> dict[str, FieldKind]:
    kinds = [
        _continuous("Image"),
        _continuous("Color"),
        _continuous("Features"),
        _continuous("Depth", constrains="depth"),
        _continuous("Disparity", finer=2.0, constrains="depth"),
        _continuous("Relief", constrains="depth"),
        replace(
            _continuous("Normals", constrains="depth"),
            down=lambda normals: rs.renormalised(rs.block_mean(normals)),
        ),
        _continuous("Slopes", finer=0.5, constrains="depth"),
        _continuous("Incidence", constrains="depth"),
        FieldKind("Boundaries", SPECS["Boundaries"], rs.any_down, rs.nearest_up, constrains="boundaries"),
        FieldKind("BoundaryKinds", SPECS["BoundaryKinds"], rs.most_significant_down, rs.nearest_up),
        FieldKind("Regions", SPECS["Regions"], rs.most_frequent_down, rs.nearest_up, constrains="boundaries"),
        FieldKind("Mask", SPECS["Mask"], rs.any_down, rs.nearest_up),
        _continuous("Confidence"),
        _continuous("Sigma"),
        FieldKind("Camera", None, lambda camera: camera.halved(), lambda camera, size: camera.doubled(size)),
        FieldKind("Light"),
        FieldKind("Scalars", SPECS["Scalars"]),
        FieldKind("Scalar"),
        FieldKind("Flag"),
        FieldKind("Text"),
    ]
    return {kind.name: kind for kind in kinds}


KINDS: Mapping[str, FieldKind] = MappingProxyType(_table())
"""The built-in field kinds by name; plugins add theirs through the ``visint_fields`` hook."""


def down(value: Any, kind: FieldKind) -> Any:
    """Any value of ``kind``, evidence, lists and None included, one level coarser."""
    if value is None:
        return None
    if isinstance(value, tuple):
        return tuple(down(one, kind) for one in value)
    if isinstance(value, Evidence):
        sigma = rs.block_mean(value.sigma) * np.float32(1 / kind.finer)
        trust = rs.block_mean(value.reliability)
        return type(value).of(kind.downward(value.value), sigma, trust)
    return _frozen(kind.downward(value))


def up(value: Any, kind: FieldKind, size: Size, how: Interpolation | None = None) -> Any:
    """Any value of ``kind``, evidence, lists and None included, one level finer, of ``size``."""
    if value is None:
        return None
    if isinstance(value, tuple):
        return tuple(up(one, kind, size, how) for one in value)
    if isinstance(value, Evidence):
        sigma = rs.linear_up(value.sigma, size) * np.float32(kind.finer)
        trust = rs.linear_up(value.reliability, size)
        return type(value).of(kind.upward(value.value, size, how), sigma, trust)
    return _frozen(kind.upward(value, size, how))


def _frozen(value: Any) -> Any:
    return read_only(value) if isinstance(value, np.ndarray) else value
