"""The light: distant, at a point, or unknown."""

from __future__ import annotations

import math
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator

from visint.arrays import Array

__all__ = ["Light"]


class Light(BaseModel):
    """One light source in the reference camera's frame (x right, y down, z forward).

    Made by :meth:`distant`, :meth:`at` or :meth:`unknown`. A distant light's vector is a unit vector from
    the surface **to** the light: right behind the camera is ``(0, 0, -1)``.
    """

    __kind__: ClassVar[str] = "Light"
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    place: Literal["distant", "point", "unknown"]
    vector: tuple[float, float, float] | None = None

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.vector is None) != (self.place == "unknown"):
            raise ValueError("a distant light and one at a point have a vector, an unknown one has none")
        if self.place == "distant" and abs(math.hypot(*(self.vector or ())) - 1) > 1e-6:
            raise ValueError("the vector of a distant light has length 1; Light.distant(x, y, z) makes it so")
        return self

    @classmethod
    def distant(cls, x: float, y: float, z: float) -> Light:
        """A light infinitely far away in direction (x, y, z); normalised here.

        Raises
        ------
        ValueError
            If the vector is zero or not finite.
        """
        length = math.hypot(x, y, z)
        if not (length > 0 and math.isfinite(length)):
            raise ValueError(f"a distant light wants a direction; ({x}, {y}, {z}) is none")
        length = 1.0 if abs(length - 1) < 1e-15 else length  # one that is read back stays as it was
        return cls(place="distant", vector=(x / length, y / length, z / length))

    @classmethod
    def at(cls, x: float, y: float, z: float) -> Light:
        """A light at the point (x, y, z), in the unit of the baseline."""
        return cls(place="point", vector=(x, y, z))

    @classmethod
    def unknown(cls) -> Light:
        """No light is given: a shading cue may estimate one, and says how sure it is."""
        return cls(place="unknown")

    def directions(self, points: Array) -> Array:
        """Unit vectors from surface points to the light.

        Parameters
        ----------
        points
            float32 (H, W, 3), positions in the camera frame.

        Returns
        -------
        float32, broadcastable to (H, W, 3): (3,) for a distant light, (H, W, 3) for one at a point.

        Raises
        ------
        ValueError
            If the light is unknown.
        """
        if self.vector is None:
            raise ValueError("the light is unknown")
        vector = np.asarray(self.vector, dtype=np.float32)
        if self.place == "distant":
            return vector
        towards = vector - points
        with np.errstate(invalid="ignore"):  # at the light itself: NaN
            unit: Array = (towards / np.linalg.norm(towards, axis=-1, keepdims=True)).astype(np.float32)
        return unit
