"""The pairs of a bench: rendered scenes by name, real ones from folders."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import visint
from visint_lab.datasets import REAL, Pair, data_folder, pairs_in
from visint_lab.render.rendering import render
from visint_lab.scenes import names, scene

__all__ = ["gathered"]

Lit = tuple[Pair, visint.Light | None]


def gathered(on: Sequence[str] | None, what: str, size: int) -> list[Lit]:
    """Pairs with truth, and the light where it is known.

    Parameters
    ----------
    on
        Scene names, beginnings of them, or folders. Without a word: the real pairs for ``stereo``, both sets
        for ``run``.
    """
    if not on:
        on = [str(data_folder(part)) for part in REAL] if what == "stereo" else ["a/", "b/"]
    return [lit for one in on for lit in _of(one, size)]


def _of(one: str, size: int) -> list[Lit]:
    chosen = [one] if one in names() else list(names(one))
    if chosen and not Path(one).is_dir():
        return [_rendered(name, size) for name in chosen]
    pairs = (files.read() for files in pairs_in(one))
    return [(pair, None) for pair in pairs if pair.disparity is not None]


def _rendered(name: str, size: int) -> Lit:
    rendering = render(scene(name, size))
    return Pair.of(rendering), rendering.light
