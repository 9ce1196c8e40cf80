"""Evidence: what a cue says about a field, how precisely, and how sure it is that its model holds."""

from __future__ import annotations

from functools import reduce
from typing import Any, ClassVar, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator

from visint.arrays import (
    Array,
    Boundaries,
    Confidence,
    Depth,
    Disparity,
    Incidence,
    Normals,
    Relief,
    Sigma,
    Slopes,
)

__all__ = [
    "BoundariesEvidence",
    "DepthEvidence",
    "DisparityEvidence",
    "Evidence",
    "IncidenceEvidence",
    "NormalsEvidence",
    "ReliefEvidence",
    "SlopesEvidence",
    "known",
]


def known(value: Array) -> Array:
    """Bool (H, W): where a field has a value, that is, no NaN in any channel.

    ``value`` is any array of two axes or more; booleans and integers are known everywhere.
    """
    if not np.issubdtype(value.dtype, np.floating):
        return np.ones(value.shape[:2], dtype=bool)
    if value.ndim == 2:
        return np.isfinite(value)
    channels = value.reshape(*value.shape[:2], -1)  # one at a time: numpy is slow over a short last axis
    finite = (np.isfinite(channels[..., c]) for c in range(channels.shape[2]))
    return reduce(np.logical_and, finite, np.ones(value.shape[:2], dtype=bool))


class Evidence(BaseModel):
    """What one cue says about one field, pixel by pixel.

    ``sigma`` is one standard deviation in the value's unit *if the cue's model holds*; ``reliability`` in
    [0, 1] is how sure the cue is that it does. 0 abstains, and exactly there the value is NaN (for a field
    that can be NaN). :meth:`of` makes the two agree; the constructor insists that they do.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)
    measures: ClassVar[str] = ""
    """The field kind of ``value``."""

    value: Any
    sigma: Sigma[Array, "H W"]
    reliability: Confidence[Array, "H W"]

    def _repr_html_(self) -> str:
        """Value, sigma and reliability side by side, for notebooks."""
        from visint.fields.notebook import html_of

        return html_of(self)

    @classmethod
    def of(cls, value: Array, sigma: Array | float, reliability: Array | float) -> Self:
        """Evidence that abstains wherever any of the three says so.

        Parameters
        ----------
        value
            float32 (H, W) or (H, W, C), or bool (H, W); NaN abstains.
        sigma
            Broadcastable to (H, W), in the value's unit. Not finite or not positive abstains.
        reliability
            Broadcastable to (H, W); clipped to [0, 1], NaN counts as 0.
        """
        shape = value.shape[:2]
        spread = np.broadcast_to(np.asarray(sigma, np.float32), shape)
        trust = np.nan_to_num(np.broadcast_to(np.asarray(reliability, np.float32), shape), nan=0.0)
        speaks = known(value) & np.isfinite(spread) & (spread > 0) & (trust > 0)
        if np.issubdtype(value.dtype, np.floating):
            keep = speaks.reshape(shape + (1,) * (value.ndim - 2))
            value = np.where(keep, value, np.float32(np.nan)).astype(np.float32, copy=False)
        return cls.model_validate(
            {
                "value": value,
                "sigma": np.where(speaks, spread, np.float32(np.nan)),
                "reliability": np.where(speaks, np.clip(trust, 0, 1), np.float32(0)),
            }
        )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        value: Array = self.value
        if not value.shape[:2] == self.sigma.shape == self.reliability.shape:
            raise ValueError(
                f"value {value.shape}, sigma {self.sigma.shape} and reliability "
                f"{self.reliability.shape} differ in size"
            )
        speaks = self.reliability > 0
        if not ((self.reliability >= 0) & (self.reliability <= 1)).all():
            raise ValueError("reliability lies outside [0, 1]")
        if not (self.sigma[speaks] > 0).all():
            raise ValueError("sigma is not positive where the evidence speaks")
        if value.dtype != bool and not np.array_equal(speaks, known(value)):
            raise ValueError(
                f"value is NaN where reliability is not 0, or the reverse; {type(self).__name__}.of(...) "
                "makes them agree"
            )
        return self


class DepthEvidence(Evidence):
    """Distance along the optical axis, in the unit of the baseline."""

    measures = "Depth"
    value: Depth[Array, "H W"]


class DisparityEvidence(Evidence):
    """Disparity of the left view, pixels of its level."""

    measures = "Disparity"
    value: Disparity[Array, "H W"]


class ReliefEvidence(Evidence):
    """Depth known only up to scale and tilt."""

    measures = "Relief"
    value: Relief[Array, "H W"]


class NormalsEvidence(Evidence):
    """Unit normals facing the camera; sigma in radians."""

    measures = "Normals"
    value: Normals[Array, "H W 3"]


class SlopesEvidence(Evidence):
    """Depth change per pixel, (∂Z/∂column, ∂Z/∂row); sigma of either component."""

    measures = "Slopes"
    value: Slopes[Array, "H W 2"]


class IncidenceEvidence(Evidence):
    """Cosine of the angle between normal and light, in [0, 1]: what brightness says before a direction is.

    Constrains depth through the light: 1 faces it, 0 is at the edge of its own shadow.
    """

    measures = "Incidence"
    value: Incidence[Array, "H W"]


class BoundariesEvidence(Evidence):
    """Boundaries; reliability is the coherence of each boundary pixel, 0 where the cue says nothing."""

    measures = "Boundaries"
    value: Boundaries[Array, "H W"]
