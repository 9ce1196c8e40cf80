"""Draws the figures of the stereo page beside this file.

Run from the project's root: ``python docs/explanation/stereo_figures.py``. ``stereo_errors.svg``: error,
residual and sensitivity of the 1992 matcher along a row of a cylinder, the scene of Fig. 5.10 as far as the
dissertation describes it. ``stereo_sgm.png``: a rendered pair, its disparity by semi-global matching, and the
reliability.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import visint
from visint.io import encode_png
from visint_lab.rays.finish import Plain
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Grain, Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Cylinder
from visint_lab.render.rendering import render
from visint_lab.scenes.demonstration import sphere_before_plane

ROW = 256
WIDE, HIGH, GAP = 720, 110, 34


def cylinder(size: int = 512):
    """The rendered pair, without noise; the light is behind the cameras."""
    thing = Thing(Cylinder(8.0, 12.0), Plain(0.9), (0.0, 0.0, 50.0), turned(np.pi / 2))
    rig = Rig.parallel((size, size), 800 * size / 512, 5.0)
    return render(Scene("cylinder", (thing,), Lamp("point", (0, 0, -100.0)), rig, 0.0, Grain()))


def rows(scene):
    """(label, values along the row) of the four panels; NaN off the cylinder."""
    result = visint.run("stereo", left=scene.left, right=scene.right, camera=scene.camera)
    found = result["disparity"][ROW].astype(float)
    columns = np.arange(len(found))
    matched = np.interp(columns - np.nan_to_num(found), columns, scene.right[ROW])
    slope = np.interp(columns - np.nan_to_num(found), columns, np.gradient(scene.right[ROW].astype(float)))
    on = scene.truth.foreground[ROW] & np.isfinite(found)
    panels = [
        ("left intensity", scene.left[ROW]),
        ("error of the disparity, px", found - scene.truth.disparity[ROW]),
        ("residual of the intensity R", matched - scene.left[ROW]),
        ("sensitivity |J|, per px", np.abs(slope)),
        ("reliability", result.confidence["disparity"][ROW]),
    ]
    return [(label, np.where(on, values, np.nan)) for label, values in panels]


def panel(label, values, top):
    """One line plot as SVG."""
    known = np.isfinite(values)
    low, high = min(0.0, float(values[known].min())), max(1e-6, float(values[known].max()))
    first, last = np.flatnonzero(known)[[0, -1]]
    x = (np.arange(len(values)) - first) / (last - first) * WIDE + 60
    y = top + HIGH - (np.nan_to_num(values) - low) / (high - low) * HIGH
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b, k in zip(x, y, known, strict=True) if k)
    zero = top + HIGH + low / (high - low) * HIGH
    return (
        f'<text x="60" y="{top - 6}">{label}</text>'
        f'<text x="54" y="{top + 9}" text-anchor="end">{high:.2g}</text>'
        f'<text x="54" y="{top + HIGH}" text-anchor="end">{low:.2g}</text>'
        f'<line x1="60" x2="{WIDE + 60}" y1="{zero:.1f}" y2="{zero:.1f}" stroke="#bbb"/>'
        f'<polyline points="{points}" fill="none" stroke="#1f77b4" stroke-width="1.2"/>'
    )


def errors() -> str:
    """The figure of the cylinder, as SVG."""
    drawn = [panel(label, values, 24 + i * (HIGH + GAP)) for i, (label, values) in enumerate(rows(cylinder()))]
    size = f'width="{WIDE + 80}" height="{len(drawn) * (HIGH + GAP) + 10}"'
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">'
        '<rect width="100%" height="100%" fill="white"/>'
    )
    return head + "".join(drawn) + "</svg>\n"


def sheet() -> bytes:
    """Left view, disparity (white is near) and reliability of the demonstration, side by side, as PNG."""
    scene = render(sphere_before_plane(256))
    result = visint.run("stereo_sgm", left=scene.left, right=scene.right, camera=scene.camera)
    low, high = scene.camera.disparity_range
    disparity = (np.nan_to_num(result["disparity"], nan=low) - low) / (high - low)
    shown = np.hstack([scene.left ** (1 / 2.2), disparity, result.confidence["disparity"]])
    return encode_png(np.rint(255 * shown.clip(0, 1)).astype(np.uint8))


def main() -> None:
    """Write both figures."""
    here = Path(__file__).parent
    (here / "stereo_errors.svg").write_text(errors())
    (here / "stereo_sgm.png").write_bytes(sheet())


if __name__ == "__main__":
    main()
