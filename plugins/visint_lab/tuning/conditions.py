"""Training and validation scenes: every condition of both sets, random poses by seed."""

from __future__ import annotations

from collections.abc import Iterator

from visint_lab.scenes.sets import OBJECTS

__all__ = ["CONDITIONS", "drawn"]

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
