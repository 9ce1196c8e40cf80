"""Draws the figure of the joint page.

Run from the project's root: ``python docs/explanation/joint_figures.py``. Rows are scenes of training seeds;
columns the left image, and the error of disparity (blue too near, red too far, full at 2 px) of the stereo
alone, of the joint estimate without shading's amplitude, and of the joint estimate; last the sigma it states.
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

import visint
from visint_lab.render.rendering import render
from visint_lab.scenes import scene

SCENES = (
    ("a/sphere/lambertian+2%", 31008),
    ("a/hyperboloid/lambertian", 11005),
    ("a/paraboloid/specular", 31016),
    ("b/sphere/checker+10%", 31032),
)
SIDE = 128


def systems():
    """The stereo alone, the control and the system."""
    joint = visint.load("joint")
    return visint.load("stereo"), visint.alter(joint, control="shading"), joint


def signed(error, inside, full=2.0):
    """White where right, red and blue where wrong, grey around the object."""
    part = np.clip(np.nan_to_num(error) / full, -1, 1)[..., None]
    colour = np.where(part > 0, 1 - part * np.array([0, 1, 1]), 1 + part * np.array([1, 1, 0]))
    return np.where(inside[..., None], colour, 0.75)


def square(picture, inside):
    """What is around the object, at one size."""
    rows, columns = np.nonzero(inside)
    half = max(np.ptp(rows), np.ptp(columns)) // 2 + 4
    y, x = (rows.min() + rows.max()) // 2, (columns.min() + columns.max()) // 2
    cut = picture[max(y - half, 0) : y + half, max(x - half, 0) : x + half]
    return cv2.resize(cut.astype(np.float32), (SIDE, SIDE), interpolation=cv2.INTER_AREA)


def row(name, seed):
    """One scene in all columns, (SIDE, 5 SIDE, 3)."""
    pair = render(scene(name, 256, seed), seed=seed)
    truth, inside = pair.truth, pair.truth.foreground
    panels = [np.repeat(pair.left[..., None], 3, axis=-1)]
    for graph in systems():
        given = {key: getattr(pair, key) for key in ("left", "right", "camera", "light")}
        found = visint.run(graph, {key: value for key, value in given.items() if key in graph.inputs})
        panels.append(signed(truth.disparity - found["disparity"], inside))
    fb = pair.camera.focal_length * pair.camera.baseline
    sigma = found["depth_sigma"] * fb / found["depth"] ** 2
    panels.append(
        np.repeat(np.where(inside, np.clip(np.nan_to_num(sigma, nan=1), 0, 1), 0.75)[..., None], 3, -1)
    )
    return np.concatenate([square(panel, inside) for panel in panels], axis=1)


def main():
    """Writes ``docs/gallery/joint/terms.jpg``."""
    picture = np.concatenate([row(*one) for one in SCENES])
    target = Path(__file__).parents[1] / "gallery/joint/terms.jpg"
    target.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(target), (255 * picture[..., ::-1]).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, 88])


if __name__ == "__main__":
    main()
