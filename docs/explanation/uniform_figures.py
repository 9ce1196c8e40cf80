"""Draws the figures of the page on the uniform hub beside this file.

Run from the project's root: ``python docs/explanation/uniform_figures.py``. ``uniform_one.svg`` and
``uniform_hub.svg`` are what ``visint show --html`` draws: one module and the map (Fig. 5.4 of the
dissertation), and the sequence of modules inside its levels (Figs. 5.5 and 5.6). ``uniform_sphere.png``: the
left view, depth of stereo alone and of the hub, the boundaries that are left, and the map's confidence.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import visint
from visint.graph.drawing import spec_of, to_svg
from visint.io import encode_png
from visint_lab.render.rendering import render
from visint_lab.scenes import scene

HERE = Path(__file__).parent
ONE = """visint: 1
name: one_module
inputs: {left: Image, right: Image, camera: Camera}
loops:
  levels: {over: pyramid, coarsest: 8}
  sweeps: {inside: levels, times: 20}
hub:
  uses: bayes.uniform
  loop: sweeps
  start: {depth: plane, boundaries: none}
  order: [stereo]
  spokes: {stereo: {uses: stereo.sgm}}
outputs: {depth: map.depth}
"""


def drawn() -> None:
    """Both graphs."""
    one = HERE / "one_module.yaml"
    one.write_text(ONE, encoding="utf-8")
    for source, name in ((str(one), "uniform_one.svg"), ("uniform_bayesian", "uniform_hub.svg")):
        (HERE / name).write_text(to_svg(spec_of(source)), encoding="utf-8")
    one.unlink()


def nearness(depth, truth):
    """Grey, white is near; black off the object."""
    low, high = np.nanmin(truth), np.nanmax(truth)
    shade = np.clip((high - depth) / (high - low), 0, 1)
    return np.where(np.isfinite(truth), np.nan_to_num(shade), 0)


def main() -> None:
    """Everything."""
    drawn()
    pair = render(scene("b/sphere/checker+10%", 256), seed=0)
    offered = {"left": pair.left, "right": pair.right, "camera": pair.camera}
    alone = visint.run("stereo", offered)
    together = visint.run("uniform_bayesian", {**offered, "light": pair.light})
    truth = pair.truth.depth
    shown = [
        np.clip(pair.left, 0, 1) ** (1 / 2.2),
        nearness(alone["depth"], truth),
        nearness(together["depth"], truth),
        together["boundaries"].astype(float),
        together.confidence["depth"],
    ]
    picture = (255 * np.hstack(shown)).astype(np.uint8)
    (HERE / "uniform_sphere.png").write_bytes(encode_png(picture))


if __name__ == "__main__":
    main()
