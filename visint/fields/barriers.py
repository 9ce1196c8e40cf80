"""Neighbours on one's own side: means, bends and medians of a field that do not cross a boundary.

Boundaries are lines of pixels, which bar every step onto them (:func:`links`), or between the regions that
they close (:func:`links_within`).
"""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["AROUND", "EIGHT", "FOUR", "bend", "bend_of_slopes", "links", "links_within", "mean", "sides"]

AROUND = ((-1, 0), (0, 1), (1, 0), (0, -1), (-1, -1), (-1, 1), (1, 1), (1, -1))
"""Neighbours (row, column) in the order of the bits of :func:`links`: above, right, below, left; corners."""
FOUR, EIGHT = 4, 8
"""How many of :data:`AROUND` a neighbourhood has."""


def links(boundaries: Array | None, size: tuple[int, int]) -> Array:
    """uint8 (H, W): bit k is set where neighbour k of :data:`AROUND` is on the same side.

    A pixel of a line has no neighbours and is nobody's; a diagonal step between two pixels of a line is barred.

    Parameters
    ----------
    boundaries
        bool (H, W), or None where there are none.
    size
        (rows, columns).
    """
    from visint.fields import _kernels

    lines = np.zeros(size, dtype=bool) if boundaries is None else boundaries
    reached = np.empty(size, dtype=np.uint8)
    _kernels.links(lines, reached)
    return reached


def sides(boundaries: Array, field: Array) -> Array:
    """int32 (H, W): the region of each pixel, closed by boundaries, from 1; lines belong to one of their sides.

    Boundaries have no width: a line's pixel belongs to the region beside it whose ``field`` is nearest to its
    own. Where lines are so thick that a pixel touches no region it has none, 0.

    Parameters
    ----------
    boundaries
        bool (H, W).
    field
        float32 (H, W), NaN unknown: depth, or brightness.
    """
    import cv2

    from visint.fields import _kernels

    _, labels = cv2.connectedComponents((~boundaries).astype(np.uint8), connectivity=4)
    owned = np.empty(field.shape, dtype=np.int32)
    _kernels.owners(labels, field, owned)
    return owned


def links_within(boundaries: Array | None, field: Array) -> Array:
    """:func:`links` of the regions that boundaries close, each pixel of a line on one of its sides.

    A line's pixel shares what it knows with its side (:func:`sides`). A line that closes nothing bars nothing.
    Where a pixel touches no region, it has no neighbours.

    Parameters
    ----------
    boundaries
        bool (H, W), or None where there are none.
    field
        float32 (H, W), NaN unknown.
    """
    from visint.fields import _kernels

    if boundaries is None:
        return links(None, field.shape)
    reached = np.empty(field.shape, dtype=np.uint8)
    _kernels.links_of(sides(boundaries, field), reached)
    return reached


def mean(values: Array, reached: Array, neighbours: int = FOUR) -> tuple[Array, Array]:
    """Mean of the known neighbours on one's own side, and how many they are.

    Parameters
    ----------
    values
        float32 (H, W), NaN unknown.
    reached
        From :func:`links`.
    neighbours
        :data:`FOUR` or :data:`EIGHT`.

    Returns
    -------
    float32 (H, W), NaN where there is no neighbour, and uint8 (H, W).
    """
    from visint.fields import _kernels

    average, count = np.empty_like(values), np.empty(values.shape, dtype=np.uint8)
    _kernels.mean(values, reached, neighbours, average, count)
    return average, count


def bend(values: Array, reached: Array) -> Array:
    """The signed quarter-Laplacian (Eq. 5.82): how far the mean of the four neighbours lies above a pixel.

    An axis counts where both of its neighbours are known and on the pixel's own side, so a plane has no bend,
    at the border of its region either. 0 where no axis counts.

    Parameters
    ----------
    values
        float32 (H, W), NaN unknown.
    reached
        From :func:`links`.
    """
    from visint.fields import _kernels

    found = np.empty_like(values)
    _kernels.bend(values, reached, found)
    return found


def bend_of_slopes(slopes: Array, reached: Array) -> Array:
    """What :func:`bend` would be of the surface with these ``slopes``, float32 (H, W, 2), change per pixel.

    A quarter of their divergence, by central differences; NaN where no axis counts: no slopes are known there.
    """
    from visint.fields import _kernels

    found = np.empty(slopes.shape[:2], dtype=np.float32)
    _kernels.bend_of_slopes(slopes, reached, found)
    return found
