"""Where the surface is sought, and where it is cut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array

__all__ = ["Domain"]


@dataclass(frozen=True, slots=True)
class Domain:
    """Pixels that belong to surfaces, and which neighbours lie on the same one. All bool (H, W) but ``pieces``.

    ``across``/``down``: a pixel and its right/lower neighbour are joined. ``pieces`` int32: connected parts,
    from 1; 0 outside.
    """

    inside: Array
    across: Array
    down: Array
    pieces: Array

    @classmethod
    def of(cls, mask: Array, cut_across: Array | None = None, cut_down: Array | None = None) -> Domain:
        """The pixels of ``mask``, neighbours joined unless cut (bool (H, W), of the left/upper one of two)."""
        across, down = np.zeros_like(mask), np.zeros_like(mask)
        across[:, :-1] = mask[:, :-1] & mask[:, 1:]
        down[:-1] = mask[:-1] & mask[1:]
        if cut_across is not None:
            across &= ~cut_across
        if cut_down is not None:
            down &= ~cut_down
        return cls(mask, across, down, _pieces(mask, across, down))

    @property
    def box(self) -> tuple[slice, slice]:
        """The smallest rectangle around it."""
        rows, columns = (np.nonzero(self.inside.any(axis=axis))[0] for axis in (1, 0))
        if not rows.size:
            return slice(0, 1), slice(0, 1)
        return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)

    def cut_out(self, box: tuple[slice, slice]) -> Domain:
        """What lies in a rectangle that holds all of it."""
        return Domain(
            *(np.ascontiguousarray(part[box]) for part in (self.inside, self.across, self.down, self.pieces))
        )


def _pieces(mask: Array, across: Array, down: Array) -> Array:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    if across[:, :-1].sum() == (mask[:, :-1] & mask[:, 1:]).sum() and (
        down[:-1].sum() == (mask[:-1] & mask[1:]).sum()
    ):
        import cv2

        return np.asarray(cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)[1], np.int32)
    number = np.arange(mask.size).reshape(mask.shape)
    ends = [
        np.concatenate([number[across], number[down]]),
        np.concatenate([number[np.roll(across, 1, 1)], number[np.roll(down, 1, 0)]]),
    ]
    graph = coo_matrix((np.ones(len(ends[0]), bool), (ends[0], ends[1])), shape=(mask.size, mask.size))
    labels = connected_components(graph, directed=False)[1].reshape(mask.shape)
    _, dense = np.unique(np.where(mask, labels + 1, 0), return_inverse=True)
    return np.asarray(dense.reshape(mask.shape) + (0 if (~mask).any() else 1), np.int32)
