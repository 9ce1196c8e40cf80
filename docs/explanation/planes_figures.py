"""Draws the figure of region planes on the grouping page: ``docs/gallery/grouping/planes.png``.

Run from the project's root: ``python docs/explanation/planes_figures.py``; wants the public pairs
(``VISINT_DATA``).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import visint
from visint.fields.resampling import block_mean, region_boundaries
from visint.io import encode_png
from visint_lab.datasets import data_folder, pairs_in

PAIR = "mb2014q/Piano"
SPAN = (5.0, 60.0)
WORST = 4.0


def shown(disparity):
    """Disparity as brightness, unknown black."""
    return np.nan_to_num((disparity - SPAN[0]) / (SPAN[1] - SPAN[0]), nan=0.0).clip(0, 1)


def sheet() -> bytes:
    """View with regions, planes where they speak, errors of matching alone and of the whole; as PNG."""
    pair = pairs_in(data_folder(PAIR))[0].read()
    given = {"left": pair.left, "right": pair.right, "camera": pair.camera}
    alone = visint.run("stereo_sgm", **given)
    graph = visint.load("stereo_planes")
    whole = visint.run(graph, **given)
    view = 0.7 * pair.left ** (1 / 2.2)
    view[region_boundaries(whole["regions"])] = 1
    errors = [(np.abs(result["disparity"] - pair.disparity) / WORST).clip(0, 1) for result in (alone, whole)]
    parts = [view, shown(whole["disparity"]), *errors]
    parts = [block_mean(np.nan_to_num(part).astype(np.float32)) for part in parts]
    grid = np.vstack([np.hstack(parts[:2]), np.hstack(parts[2:])])
    return encode_png(np.rint(63 * grid).astype(np.uint8) * 4)


def main() -> None:
    """Write the figure."""
    root = Path(__file__).parents[1] / "gallery" / "grouping"
    (root / "planes.png").write_bytes(sheet())


if __name__ == "__main__":
    main()
