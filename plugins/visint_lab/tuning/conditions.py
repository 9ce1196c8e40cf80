"""Training and validation scenes: every condition of both sets, random poses by seed."""

from __future__ import annotations

from collections.abc import Iterator

from visint_lab.scenes.sets import OBJECTS, SCANS, SURFACES

__all__ = ["CONDITIONS", "OTHERS", "drawn", "with_others"]

CONDITIONS = (
    "a/{}/lambertian",
    "a/{}/lambertian+2%",
    "a/{}/specular",
    "a/{}/specular+2%",
    "b/{}/checker",
    "b/{}/checker+10%",
    "b/{}/checker+x10%",
)


def drawn(first: int, rounds: int) -> Iterator[tuple[str, int]]:
    """Names and seeds: each round has each of the six objects in each condition once, every seed once.

    Rounds lie 1000 seeds apart, so that ranges of seeds tell training from validation.
    """
    for turn in range(rounds):
        scenes = (condition.format(thing) for condition in CONDITIONS for thing in OBJECTS)
        for number, name in enumerate(scenes, 1):
            yield name, first + 1000 * turn + number


OTHERS = (
    *(f"b/mozart/{surface}" for surface in SURFACES["mozart"]),
    *(f"b/mozart/{surface}+10%" for surface in SURFACES["mozart"]),
    *(f"range/{scan}" for scan in SCANS),
    *(f"range/{scan}+2%" for scan in SCANS[:3]),
)
"""Surfaces that nothing is trained on; they need the data folder. With one round of primitives, 60 scenes."""


def with_others(first: int) -> Iterator[tuple[str, int]]:
    """One round of :func:`drawn` and the surfaces that nothing is trained on; only their noise has a seed."""
    yield from drawn(first, 1)
    yield from ((name, first + 500 + number) for number, name in enumerate(OTHERS))
