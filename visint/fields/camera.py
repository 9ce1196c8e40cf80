"""The camera of a rectified pair."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

__all__ = ["Camera"]


class Camera(BaseModel):
    """Intrinsics of the reference (left) view of a rectified pair, in pixels of its own level.

    Frame: x right, y down, z forward; pixel centres at integer coordinates. Depth is
    ``Z = f B / (d + doffs)`` in the unit of the baseline.

    Parameters
    ----------
    focal_length
        f, pixels.
    cx, cy
        Principal point, pixels.
    baseline
        B, distance between the two centres; its unit is the unit of all depth.
    width, height
        Image size, pixels.
    doffs
        x-difference of the principal points (right minus left), pixels. Converging rigs have a large one.
    disparity_range
        Smallest and largest disparity to search, pixels; None if not known.
    unit
        The baseline's unit; ``"relative"`` where there is no calibration and depth is known only up to scale.
    """

    __kind__: ClassVar[str] = "Camera"
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    focal_length: float = Field(gt=0)
    cx: float
    cy: float
    baseline: float = Field(gt=0)
    width: int = Field(gt=0)
    height: int = Field(gt=0)
    doffs: float = 0.0
    disparity_range: tuple[float, float] | None = None
    unit: str = "mm"

    @model_validator(mode="after")
    def _range_ascends(self) -> Self:
        span = self.disparity_range
        if span is not None and span[0] > span[1]:
            raise ValueError(f"disparity_range is (smallest, largest); {span} falls")
        return self

    @classmethod
    def uncalibrated(
        cls, width: int, height: int, disparity_range: tuple[float, float] | None = None
    ) -> Camera:
        """A stand-in where nothing is known: 53° of view, baseline 1, unit ``"relative"``.

        Depth from it is right only up to scale, and the shape only up to a stretch along the line of sight.
        """
        return cls(
            focal_length=float(width),
            cx=(width - 1) / 2,
            cy=(height - 1) / 2,
            baseline=1.0,
            width=width,
            height=height,
            disparity_range=disparity_range,
            unit="relative",
        )

    @property
    def size(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self.height, self.width

    @property
    def calibrated(self) -> bool:
        """Whether depth has a real unit."""
        return self.unit != "relative"

    @property
    def middle_disparity(self) -> float | None:
        """The middle of the search range, pixels: where a fronto-parallel start plane lies."""
        return None if self.disparity_range is None else sum(self.disparity_range) / 2

    def halved(self) -> Camera:
        """The camera one level coarser: factor exactly 2, centres map by (x + ½)/2 − ½, odd sides padded."""
        span = self.disparity_range
        return self.model_copy(
            update={
                "focal_length": self.focal_length / 2,
                "cx": (self.cx + 0.5) / 2 - 0.5,
                "cy": (self.cy + 0.5) / 2 - 0.5,
                "doffs": self.doffs / 2,
                "width": (self.width + 1) // 2,
                "height": (self.height + 1) // 2,
                "disparity_range": None if span is None else (span[0] / 2, span[1] / 2),
            }
        )

    def doubled(self, size: tuple[int, int]) -> Camera:
        """The camera one level finer, whose image has ``size`` (rows, columns)."""
        span = self.disparity_range
        return self.model_copy(
            update={
                "focal_length": self.focal_length * 2,
                "cx": (self.cx + 0.5) * 2 - 0.5,
                "cy": (self.cy + 0.5) * 2 - 0.5,
                "doffs": self.doffs * 2,
                "width": size[1],
                "height": size[0],
                "disparity_range": None if span is None else (span[0] * 2, span[1] * 2),
            }
        )
