"""Middlebury's folders, old and new, and ETH3D's two-view ones, which are laid out alike."""

from __future__ import annotations

from pathlib import Path

from visint_lab.datasets.pair import PairFiles

__all__ = ["middlebury_pair"]

_IMAGES = (
    ("left", "right"),
    ("im0", "im1"),  # 2014, 2021 and ETH3D
    ("view1", "view5"),  # 2005, 2006
    ("im2", "im6"),  # 2001, 2003
)
_SUFFIXES = (".png", ".ppm", ".pgm", ".jpg", ".jpeg", ".pfm")
_TRUTHS = ("disp_left", "disp0GT", "disp0", "disp1", "disp2", "truedisp")
_TRUTHS_RIGHT = ("disp_right", "disp1GT", "disp5", "disp6")
_MASKS = ("mask_nocc", "mask0nocc", "mask_nonocc")


def middlebury_pair(folder: Path) -> PairFiles | None:
    """The pair in ``folder``, or None if it is none. A ``meta.json`` beside it may say scale and range.

    Without one the scale of an image of disparities follows from the collection: 8 for the pairs of 2001
    (``.ppm``), 4 for those of 2003, 3 or 2 for ``ThirdSize`` and ``HalfSize`` in the path, else 1.
    """
    for names in _IMAGES:
        left, right = (_first(folder, (name,)) for name in names)
        if left is not None and right is not None:
            return _described(folder, left, right)
    return None


def _described(folder: Path, left: Path, right: Path) -> PairFiles:
    scale, largest = _meta(folder)
    scale = scale or _customary_scale(left)
    calibration = folder / "calib.txt"
    return PairFiles(
        name="/".join(folder.resolve().parts[-2:]),
        left=left,
        right=right,
        disparity=_first(folder, _TRUTHS),
        disparity_right=_right_truth(folder, left),
        mask=_first(folder, _MASKS),
        calibration=calibration if calibration.is_file() else None,
        scale=scale,
        span=(0.0, float(int(largest or 255 / scale) + 2)),
    )


def _right_truth(folder: Path, left: Path) -> Path | None:
    found = _first(folder, _TRUTHS_RIGHT)
    if found is None and left.stem == "im0":
        return _first(folder, ("disp1",))
    return found


def _first(folder: Path, names: tuple[str, ...]) -> Path | None:
    candidates = (folder / (name + suffix) for name in names for suffix in _SUFFIXES)
    return next((path for path in candidates if path.is_file()), None)


def _meta(folder: Path) -> tuple[float, float]:
    from visint.io import read_json

    path = folder / "meta.json"
    found = read_json(path) if path.is_file() else {}
    return float(found.get("gt_scale", 0)), float(found.get("ndisp_gt_max", 0))


def _customary_scale(left: Path) -> float:
    where = str(left.parent.resolve()).lower()
    if left.stem in ("im2", "left"):
        return 8.0 if left.suffix == ".ppm" else 4.0
    for size, scale in (("third", 3.0), ("half", 2.0)):
        if size in where:
            return scale
    return 1.0
