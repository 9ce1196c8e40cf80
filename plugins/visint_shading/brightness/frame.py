"""The part of a view in which there is something to find."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Evidence

__all__ = ["Frame", "frame_of"]

E = TypeVar("E", bound=Evidence)


class Frame(NamedTuple):
    """A box of rows and columns, inside a whole of ``size`` (rows, columns)."""

    box: tuple[slice, slice]
    size: tuple[int, int]

    @classmethod
    def around(cls, shape: tuple[int, ...]) -> Frame:
        """The box that holds a whole image of ``shape``."""
        rows, columns = shape[:2]
        return cls((slice(0, rows), slice(0, columns)), (rows, columns))

    def camera(self, whole: Camera) -> Camera:
        """The camera that has only this part of the image."""
        rows, columns = self.box
        return whole.model_copy(
            update={
                "cx": whole.cx - columns.start,
                "cy": whole.cy - rows.start,
                "width": columns.stop - columns.start,
                "height": rows.stop - rows.start,
            }
        )

    def part(self, whole: Array) -> Array:
        """The box of an array (H, W, …)."""
        return np.ascontiguousarray(whole[self.box])

    def whole(self, part: Array) -> Array:
        """``part`` in its place, around it NaN (0 if it holds no floats)."""
        return self._within(part, np.nan if np.issubdtype(part.dtype, np.floating) else 0)

    def evidence(self, kind: type[E], value: Array, sigma: Array, reliability: Array) -> E:
        """Evidence (H, W) that says what these say in the box, and nothing around it."""
        part = kind.of(value, sigma, reliability)
        return kind(
            value=self.whole(part.value),
            sigma=self.whole(part.sigma),
            reliability=self._within(part.reliability, 0),
        )

    def _within(self, part: Array, around: float) -> Array:
        if part.shape[:2] == self.size:
            return part
        found = np.full((*self.size, *part.shape[2:]), around, part.dtype)
        found[self.box] = part
        return found


def frame_of(labels: Array) -> Frame:
    """The smallest box that holds every label, one pixel at least."""
    rows, columns = (np.flatnonzero((labels > 0).any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return Frame((slice(0, 1), slice(0, 1)), labels.shape)
    return Frame((slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)), labels.shape)
