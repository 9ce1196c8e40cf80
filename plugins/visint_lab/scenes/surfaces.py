"""Range surfaces that are data, not formulas: found under ``VISINT_DATA``, never shipped."""

from __future__ import annotations

from functools import cache
from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from visint_lab.datasets.places import data_folder
from visint_lab.rays.shapes import HeightMap

__all__ = ["diligent", "mozart"]


def mozart(width: float = 31.0) -> HeightMap:
    """The Mozart bust, ``width`` units across the frame's 256 columns, centred, without its background.

    Holes of the scan inside the figure are closed by the mean of what is around them.

    Raises
    ------
    InputError
        If the data is not there.
    """
    heights = _mozart_heights()
    return _centred(heights, width / heights.shape[1])


@cache
def _mozart_heights() -> NDArray[np.float64]:
    from scipy.io import loadmat

    from visint.io import read_bytes

    packed = read_bytes(data_folder("extra/mozart_range") / "mozart.mat")
    return _solid(np.asarray(loadmat(BytesIO(packed))["mozart"], dtype=np.float64))


def diligent(name: str, extent: float = 17.0) -> HeightMap:
    """The scanned figure ``name`` (bear, buddha, cat, pot1, reading), ``extent`` units wide or high at most."""
    from visint.io import read_npz

    depth = read_npz(data_folder(f"extra/diligent_gt/{name}") / "depth_gt.npz")["depth_gt"].astype(np.float64)
    inside = np.isfinite(depth) & (depth > 0)
    rows, columns = np.nonzero(inside)
    crop = np.s_[rows.min() - 4 : rows.max() + 5, columns.min() - 4 : columns.max() + 5]
    # Seen from far away with a long lens: what a pixel spans is the same over the whole figure.
    heights = np.where(inside, np.nanmax(depth) - depth, 0.0)[crop]
    figure = np.where(inside[crop], heights / _span(depth, name), np.nan)
    return _centred(figure, extent / max(np.ptp(columns), np.ptp(rows)))


def _span(depth: NDArray[np.float64], name: str) -> float:
    """Millimetres a pixel."""
    from visint.io import read_text

    focal_length = float(read_text(data_folder(f"extra/diligent_gt/{name}") / "K.txt").split()[0])
    return float(np.nanmedian(depth)) / focal_length


def _solid(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """The largest connected figure above 0, its inner holes filled; NaN around it."""
    from scipy.ndimage import binary_closing, binary_fill_holes, label

    figure = binary_fill_holes(binary_closing(np.pad(heights > 0, 8, mode="edge"), iterations=2))[8:-8, 8:-8]
    labels, _ = label(figure)
    figure = labels == np.bincount(labels.ravel())[1:].argmax() + 1
    return np.where(figure, _filled(heights, heights > 0), np.nan)


def _filled(heights: NDArray[np.float64], known: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Unknown samples as means of known ones nearby, nearest counting most."""
    from scipy.ndimage import gaussian_filter

    share = gaussian_filter(known.astype(np.float64), 2.0) + 1e-9
    return np.where(known, heights, gaussian_filter(np.where(known, heights, 0.0), 2.0) / share)


def _centred(heights: NDArray[np.float64], pitch: float) -> HeightMap:
    """In scene units (heights come in samples), the middle of its range of heights at the origin."""
    scaled = heights * pitch
    return HeightMap(scaled - (np.nanmin(scaled) + np.nanmax(scaled)) / 2, pitch)
