"""Arrays on ports: what a port declares, and the public array types it is declared with.

``Depth[Array, "H W"]`` reads as ``Annotated[Array, "H W"]`` to a type checker; at run time it is an array
annotated with an :class:`ArraySpec` that pydantic holds every value against.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic_core import core_schema

__all__ = [
    "SPECS",
    "Array",
    "ArrayKind",
    "ArraySpec",
    "Boundaries",
    "BoundaryKinds",
    "Color",
    "Confidence",
    "Depth",
    "Disparity",
    "Features",
    "Image",
    "Incidence",
    "Mask",
    "Normals",
    "Regions",
    "Relief",
    "Scalars",
    "Sigma",
    "Slopes",
    "read_only",
]

Array: TypeAlias = NDArray[Any]
"""Any numpy array; the kind beside it says of what type and shape."""


def read_only(array: Array) -> Array:
    """``array`` itself if nobody can write through it, else a read-only C-contiguous view (or copy)."""
    flags = array.flags
    if not flags.c_contiguous:
        array = np.ascontiguousarray(array)
    elif not flags.writeable:
        return array
    array = array.view()
    array.flags.writeable = False
    return array


@dataclass(frozen=True, slots=True)
class ArraySpec:
    """What an array on a port is: kind, dtype, named dims and unit.

    Raises TypeError for a dtype that is neither numbers nor booleans.

    Parameters
    ----------
    kind
        The field kind's name, such as ``"Depth"``; a stranger's is qualified: ``"flow.Flow"``.
    dtype
        A numpy dtype name. Values are never cast: another dtype is refused.
    dims
        One entry an axis: a name (ports of a node that name the same dim must agree) or a fixed length.
    unit
        For people and labels: ``"px"``, ``"baseline"``, ``"rad"``, ``"1"``.
    """

    kind: str
    dtype: str
    dims: tuple[str | int, ...]
    unit: str = "1"
    _dtype: np.dtype[Any] = field(init=False, repr=False, compare=False)
    _fixed: tuple[tuple[int, int], ...] = field(init=False, repr=False, compare=False)
    _ndim: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_dtype", np.dtype(self.dtype))
        if self._dtype.kind not in "biufc":
            raise TypeError(f"{self.kind} is of {self.dtype}; arrays on ports hold numbers or booleans")
        fixed = tuple((i, d) for i, d in enumerate(self.dims) if isinstance(d, int))
        object.__setattr__(self, "_fixed", fixed)
        object.__setattr__(self, "_ndim", len(self.dims))

    def __str__(self) -> str:
        return f"{self.kind} {self.dtype} ({', '.join(map(str, self.dims))})"

    def check(self, value: object) -> Array:
        """``value`` as a read-only array of this spec.

        Raises
        ------
        ValueError
            If it is no array, or of another dtype or shape; says both what was found and wanted.
        """
        if type(value) is not np.ndarray:
            value = self._plain(value)
        if value.dtype is not self._dtype and value.dtype != self._dtype:
            raise ValueError(f"wants {self}; this array is {value.dtype}")
        if value.ndim != self._ndim or (self._fixed and any(value.shape[i] != n for i, n in self._fixed)):
            raise ValueError(f"wants {self}; this array has shape {value.shape}")
        flags = value.flags
        return value if flags.c_contiguous and not flags.writeable else read_only(value)

    def _plain(self, value: object) -> Array:
        """A subclass as a plain array: memory maps and matrices may come in, a mask would be lost."""
        if not isinstance(value, np.ndarray):
            raise ValueError(f"wants {self}; this is a {type(value).__name__}, not a numpy array")
        if isinstance(value, np.ma.MaskedArray):
            raise ValueError(f"wants {self}; this is a masked array; write array.filled(np.nan)")
        return value.view(np.ndarray)

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)


class ArrayKind:
    """A family of array types, subscripted on a port: ``Depth[Array, "H W"]``.

    Parameters
    ----------
    kind
        The field kind's name. A plugin's own is qualified by its entry point: ``"flow.Flow"``.
    dtype, dims, unit
        As in :class:`ArraySpec`; ``dims`` is the default and fixes the number of axes.

    Examples
    --------
    A stranger's kind, for both the type checker and visint::

        __all__ = ["Flow"]  # else mypy's strict rules keep it from being imported elsewhere

        if TYPE_CHECKING:
            from typing import Annotated as Flow
        else:
            Flow = ArrayKind("flow.Flow", "float32", "H W 2", "px")
    """

    def __init__(self, kind: str, dtype: str, dims: str, unit: str = "1") -> None:
        self.spec = ArraySpec(kind, dtype, _dims(dims), unit)

    @classmethod
    def of(cls, spec: ArraySpec) -> ArrayKind:
        """The kind whose default spec is ``spec``."""
        return cls(spec.kind, spec.dtype, " ".join(map(str, spec.dims)), spec.unit)

    def __getitem__(self, item: tuple[Any, str]) -> Any:
        array, dims = item
        spec = ArraySpec(self.spec.kind, self.spec.dtype, _dims(dims), self.spec.unit)
        if len(spec.dims) != len(self.spec.dims):
            raise TypeError(f"{spec.kind} has {len(self.spec.dims)} axes, as in {self.spec}; got {dims!r}")
        if any(spec.dims[i] != n for i, n in self.spec._fixed):
            raise TypeError(f"{spec.kind} has the lengths of {self.spec}; got {dims!r}")
        return Annotated[array, spec]

    def __repr__(self) -> str:
        return self.spec.kind


def _dims(text: str) -> tuple[str | int, ...]:
    return tuple(int(word) if word.isdigit() else word for word in text.split())


SPECS: Mapping[str, ArraySpec] = MappingProxyType(
    {
        kind: ArraySpec(kind, dtype, _dims(dims), unit)
        for kind, dtype, dims, unit in (
            ("Image", "float32", "H W", "1"),
            ("Color", "float32", "H W 3", "1"),
            ("Features", "float32", "H W C", "1"),
            ("Depth", "float32", "H W", "baseline"),
            ("Relief", "float32", "H W", "1"),
            ("Disparity", "float32", "H W", "px"),
            ("Normals", "float32", "H W 3", "1"),
            ("Slopes", "float32", "H W 2", "baseline/px"),
            ("Incidence", "float32", "H W", "1"),
            ("Boundaries", "bool", "H W", "1"),
            ("BoundaryKinds", "uint8", "H W", "1"),
            ("Regions", "int32", "H W", "1"),
            ("Mask", "bool", "H W", "1"),
            ("Confidence", "float32", "H W", "1"),
            ("Sigma", "float32", "H W", "1"),
            ("Scalars", "float64", "N", "1"),
        )
    }
)
"""The built-in array kinds by name."""

if TYPE_CHECKING:
    from typing import Annotated as Boundaries
    from typing import Annotated as BoundaryKinds
    from typing import Annotated as Color
    from typing import Annotated as Confidence
    from typing import Annotated as Depth
    from typing import Annotated as Disparity
    from typing import Annotated as Features
    from typing import Annotated as Image
    from typing import Annotated as Incidence
    from typing import Annotated as Mask
    from typing import Annotated as Normals
    from typing import Annotated as Regions
    from typing import Annotated as Relief
    from typing import Annotated as Scalars
    from typing import Annotated as Sigma
    from typing import Annotated as Slopes
else:
    Image, Color, Features = (ArrayKind.of(SPECS[name]) for name in ("Image", "Color", "Features"))
    Depth, Relief, Disparity = (ArrayKind.of(SPECS[name]) for name in ("Depth", "Relief", "Disparity"))
    Normals, Slopes, Incidence = (ArrayKind.of(SPECS[name]) for name in ("Normals", "Slopes", "Incidence"))
    Boundaries, Regions, Mask = (ArrayKind.of(SPECS[name]) for name in ("Boundaries", "Regions", "Mask"))
    BoundaryKinds = ArrayKind.of(SPECS["BoundaryKinds"])
    Confidence, Sigma, Scalars = (ArrayKind.of(SPECS[name]) for name in ("Confidence", "Sigma", "Scalars"))
