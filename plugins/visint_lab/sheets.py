"""Contact sheets: scenes and their truth side by side, ``python -m visint_lab.sheets 'a/*' SHEET.png``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from fnmatch import fnmatch

import numpy as np

from visint.arrays import Array
from visint_lab.render.rendering import Rendering, render
from visint_lab.scenes import names, scene
from visint_lab.trials.page import shown_depth, shown_normals

__all__ = ["EDGE_COLORS", "contact_sheet", "shown_edges"]

EDGE_COLORS = np.array(
    [(0, 0, 0), (255, 70, 60), (255, 170, 0), (60, 200, 90), (220, 70, 220), (0, 150, 255), (150, 150, 150)],
    dtype=np.uint8,
)
"""Red, green, blue by label: none, limb, occluding, convex crease, concave crease, mark, shadow."""


def shown_edges(edges: Array) -> Array:
    """uint8 (H, W, 3): the truth's line labels in their colours, two pixels wide."""
    from scipy.ndimage import grey_dilation

    return np.asarray(EDGE_COLORS[grey_dilation(edges, size=(2, 2))])


def contact_sheet(which: Sequence[str], size: int = 128, columns: int = 2) -> Array:
    """uint8 (H, W, 3): for each scene its left and right image, depth, normals, labels and visible pixels."""
    strips = [_strip(render(scene(name, size))) for name in which]
    strips += [np.zeros_like(strips[0])] * (-len(strips) % columns)
    rows = [np.hstack(strips[k : k + columns]) for k in range(0, len(strips), columns)]
    return np.vstack(rows)


def _strip(pair: Rendering) -> Array:
    from visint.io import srgb_from_linear

    truth = pair.truth
    tiles = [srgb_from_linear(pair.left), srgb_from_linear(pair.right), shown_depth(truth.depth, truth.depth)]
    tiles += [shown_normals(truth.normals, truth.normals), shown_edges(truth.edges)]
    tiles.append((truth.visible * 255).astype(np.uint8))
    return np.hstack([tile if tile.ndim == 3 else np.repeat(tile[..., None], 3, axis=2) for tile in tiles])


def main(arguments: Sequence[str]) -> None:
    """The command line."""
    from visint.io import encode_png, write_bytes

    pattern, path = arguments
    chosen = [name for name in names() if fnmatch(name, pattern) and "+" not in name]
    write_bytes(path, encode_png(np.ascontiguousarray(contact_sheet(chosen))))


if __name__ == "__main__":
    main(sys.argv[1:])
