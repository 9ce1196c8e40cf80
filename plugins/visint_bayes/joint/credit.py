"""Whose word the surface is: a share of every pixel for each evidence, in the order of the module's ports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from visint.arrays import Array

__all__ = ["of_objects", "of_photographs"]

WITHOUT_BRIGHTNESS = ("plate", "loose")
"""Candidates that stereo and smoothness alone have made."""


def of_photographs(depth: Sequence[Array], disparity: Sequence[Array], incidence: int) -> tuple[Array, ...]:
    """One float32 (H, W) an evidence: 1 where its word was taken, the last that speaks, disparity after depth.

    Parameters
    ----------
    depth, disparity
        Reliability (H, W) of each evidence.
    incidence
        How many cues spoke of incidence: nothing is asked of them.
    """
    said = [*depth, *disparity]
    if not said:
        return ()
    taken = np.full(said[0].shape, -1)
    for k, reliability in enumerate(said):
        taken[reliability > 0] = k
    shares = [(taken == k).astype(np.float32) for k in range(len(said))]
    nothing = np.zeros(taken.shape, np.float32)
    return (*shares[len(depth) :], *shares[: len(depth)], *([nothing] * incidence))


def of_objects(parts: Mapping[str, float], inside: Array, given: tuple[int, int, int]) -> tuple[Array, ...]:
    """The same before a void: brightness has the parts of the candidates that it took part in, stereo the rest.

    Parameters
    ----------
    parts
        Of each candidate in the blend; what is missing to 1 is stereo's.
    inside
        bool (H, W): the foreground. Around it everything is stereo's.
    given
        How many evidences there are of disparity, the first being the matcher's, of depth and of incidence.
    """
    lit = sum(part for name, part in parts.items() if name not in WITHOUT_BRIGHTNESS)
    bright = np.where(inside, np.float32(lit), np.float32(0))
    disparity, depth, incidence = given
    shares = [np.zeros(inside.shape, np.float32) for _ in range(sum(given))]
    if disparity:
        shares[0] = 1 - bright
    if incidence:
        shares[disparity + depth] = bright
    return tuple(shares)
