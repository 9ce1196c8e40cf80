"""The intrinsic map: an immutable snapshot of all fields, the confidence of each, and who wrote it last."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from visint.arrays import Array, read_only
from visint.fields import geometry
from visint.fields.camera import Camera
from visint.fields.kinds import KINDS, FieldKind, Interpolation, down, up

__all__ = ["MapSnapshot", "Writer"]

_CONFIDENCE = KINDS["Confidence"]


class Writer(NamedTuple):
    """Who wrote a field last."""

    node: str
    level: int
    turn: int


@dataclass(frozen=True, slots=True, eq=False)
class MapSnapshot:
    """All fields of the map at one moment and one level; equal only to itself.

    Attributes
    ----------
    camera
        The camera of this level.
    kinds
        The kind of each stored field.
    values, confidence
        Each stored field and how sure the map is of it (float32 (H, W) in [0, 1]); None where the field has
        nothing yet. Depth is float32 (H, W), boundaries bool (H, W).
    writers
        Who wrote each field last; absent while it still has its start.
    """

    __kind__: ClassVar[str] = "Map"

    camera: Camera
    kinds: Mapping[str, FieldKind]
    values: Mapping[str, Any]
    confidence: Mapping[str, Array | None]
    writers: Mapping[str, Writer] = field(default_factory=dict)
    _derived: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def _repr_html_(self) -> str:
        """Each field and its confidence, for notebooks."""
        from visint.fields.notebook import html_of

        return html_of(self)

    def read(self, name: str) -> Any:
        """A stored field, its ``<field>_confidence``, the ``map`` itself, or a derived field.

        Derived fields (disparity, normals, slopes, regions) are computed once a snapshot, when first read.
        """
        if name == "map":
            return self
        if name in self.values:
            return self.values[name]
        if name.endswith("_confidence") and name.removesuffix("_confidence") in self.confidence:
            return self.confidence[name.removesuffix("_confidence")]
        if name not in self._derived:
            self._derived[name] = self._derive(name)
        return self._derived[name]

    def _derive(self, name: str) -> Any:
        if name == "regions":
            boundaries = self.values.get("boundaries")
            return None if boundaries is None else read_only(_regions(boundaries))
        if name not in ("disparity", "normals", "slopes"):
            raise KeyError(name)
        depth = self.values["depth"]
        if depth is None:
            return None
        if name == "disparity":
            return read_only(geometry.disparity_from_depth(depth, self.camera))
        if name == "normals":
            return read_only(geometry.normals_from_depth(depth, self.camera))
        return read_only(geometry.slopes_from_depth(depth))

    def with_field(self, name: str, value: Any, confidence: Array | None, writer: Writer) -> MapSnapshot:
        """A new snapshot in which one field is replaced; its confidence stays where None is given."""
        sure = self.confidence.get(name) if confidence is None else read_only(confidence)
        if sure is None and isinstance(value, np.ndarray):
            sure = read_only(np.zeros(value.shape[:2], np.float32))
        value = read_only(value) if isinstance(value, np.ndarray) else value
        return replace(
            self,
            values={**self.values, name: value},
            confidence={**self.confidence, name: sure},
            writers={**self.writers, name: writer},
            _derived={},
        )

    def seen_by(self, camera: Camera) -> MapSnapshot:
        """The same map through another camera of its size: what is derived follows anew."""
        return replace(self, camera=camera, _derived={})

    def finer(self, size: tuple[int, int], between: Mapping[str, Interpolation]) -> MapSnapshot:
        """The map one level finer, of ``size``; ``between`` says by kind how values are interpolated."""
        values = {
            name: up(value, self.kinds[name], size, between.get(self.kinds[name].name))
            for name, value in self.values.items()
        }
        confidence = {name: up(one, _CONFIDENCE, size) for name, one in self.confidence.items()}
        camera = self.camera.doubled(size)
        return replace(self, camera=camera, values=values, confidence=confidence, _derived={})

    def coarser(self) -> MapSnapshot:
        """The map one level coarser."""
        values = {name: down(value, self.kinds[name]) for name, value in self.values.items()}
        confidence = {name: down(one, _CONFIDENCE) for name, one in self.confidence.items()}
        return replace(self, camera=self.camera.halved(), values=values, confidence=confidence, _derived={})


def _regions(boundaries: Array) -> Array:
    """int32 (H, W): 4-connected regions between boundaries from 1, 0 on boundaries."""
    import cv2

    _, labels = cv2.connectedComponents((~boundaries).astype(np.uint8), connectivity=4)
    return np.asarray(labels, dtype=np.int32)
