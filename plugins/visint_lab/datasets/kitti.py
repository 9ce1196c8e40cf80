"""KITTI's stereo folders of 2012 and 2015."""

from __future__ import annotations

from pathlib import Path

from visint_lab.datasets.pair import PairFiles

__all__ = ["kitti_pairs"]

_LAYOUTS = (
    ("image_2", "image_3", "disp_occ_0"),
    ("image_0", "image_1", "disp_occ"),
    ("colored_0", "colored_1", "disp_occ"),
)
SCALE = 256.0


def kitti_pairs(folder: Path) -> tuple[PairFiles, ...]:
    """Every first-frame pair (``…_10.png``) in a ``training`` or ``testing`` folder; empty if it is none.

    Its calibration files are per sequence and in another format, so depth is relative; disparities run up to
    256 px.
    """
    for left, right, truth in _LAYOUTS:
        images = sorted((folder / left).glob("*_10.png"))
        found = [path for path in images if (folder / right / path.name).is_file()]
        if found:
            return tuple(_pair(path, folder / right, folder / truth) for path in found)
    return ()


def _pair(left: Path, right: Path, truths: Path) -> PairFiles:
    truth = truths / left.name
    return PairFiles(
        name=f"kitti/{left.stem}",
        left=left,
        right=right / left.name,
        disparity=truth if truth.is_file() else None,
        scale=SCALE,
        span=(0.0, 256.0),
    )
