"""Data sets: pairs with truth from folders on disk, through visint's own readers."""

from __future__ import annotations

from pathlib import Path

from visint.errors import InputError
from visint_lab.datasets.kitti import kitti_pairs
from visint_lab.datasets.middlebury import middlebury_pair
from visint_lab.datasets.pair import Pair, PairFiles
from visint_lab.datasets.places import data_folder

__all__ = ["REAL", "Pair", "PairFiles", "data_folder", "pairs_in"]

REAL = ("mb2001", "mb2003", "mb2005", "mb2006", "mb2014q")
"""The folders of real pairs under ``VISINT_DATA``."""


def pairs_in(folder: str | Path, depth: int = 3) -> tuple[PairFiles, ...]:
    """Every pair in ``folder`` and the folders inside it: Middlebury's and ETH3D's layouts, KITTI's, or plain
    ``left.*`` and ``right.*``.

    Parameters
    ----------
    depth
        How many levels of folders to look into.

    Raises
    ------
    InputError
        If there is none.
    """
    root = Path(folder)
    found = _pairs(root, depth) if root.is_dir() else ()
    if not found:
        raise InputError.of(
            "VI301",
            "there is no stereo pair in it",
            where=str(folder),
            choices="left.* and right.*; im0.png and im1.png; view1.png and view5.png; image_2 and image_3",
        )
    return found


def _pairs(folder: Path, depth: int) -> tuple[PairFiles, ...]:
    if (one := middlebury_pair(folder)) is not None:
        return (one,)
    if many := kitti_pairs(folder):
        return many
    inside = sorted(path for path in folder.iterdir() if path.is_dir()) if depth else []
    return tuple(pair for path in inside for pair in _pairs(path, depth - 1))
