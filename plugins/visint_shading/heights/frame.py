"""The part of a view in which there is something to find."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_shading.photometry import Photometry

__all__ = ["Frame", "frame_of"]


class Frame(NamedTuple):
    """A box of rows and columns, inside a whole of ``size`` (rows, columns)."""

    box: tuple[slice, slice]
    size: tuple[int, int]

    def of(self, found: Photometry) -> Photometry:
        """``found`` as a camera sees it that has only this part of the image."""
        assert found.light is not None
        rows, columns = self.box
        camera = found.camera.model_copy(
            update={
                "cx": found.camera.cx - columns.start,
                "cy": found.camera.cy - rows.start,
                "width": columns.stop - columns.start,
                "height": rows.stop - rows.start,
            }
        )
        surface = found.orientation
        return found._replace(
            camera=camera,
            seen=found.seen._replace(labels=self.part(found.seen.labels), even=self.part(found.seen.even)),
            orientation=None if surface is None else type(surface)(*(self.part(each) for each in surface)),
            light=self.part(found.light),
            incidence=self.part(found.incidence),
            sigma=self.part(found.sigma),
            reliability=self.part(found.reliability),
        )

    def part(self, whole: Array) -> Array:
        """The box of an array (H, W, …)."""
        return np.ascontiguousarray(whole[self.box])

    def whole(self, part: Array) -> Array:
        """``part`` in its place, around it NaN (0 if it holds no floats)."""
        nothing = np.nan if np.issubdtype(part.dtype, np.floating) else 0
        found = np.full((*self.size, *part.shape[2:]), nothing, part.dtype)
        found[self.box] = part
        return found


def frame_of(labels: Array) -> Frame:
    """The smallest box that holds every label, one pixel at least."""
    rows, columns = (np.flatnonzero((labels > 0).any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return Frame((slice(0, 1), slice(0, 1)), labels.shape)
    return Frame((slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)), labels.shape)
