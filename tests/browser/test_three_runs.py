"""The reports of three real runs, of a photographed pair, a rendered scene and one view alone, in a browser."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import visint
from visint import io
from visint.results.report.page import MOST_BYTES
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_lab.scenes.demonstration import sphere_before_plane

DATA = Path(os.environ.get("VISINT_DATA", Path(__file__).parents[3] / "shared/data"))

ONE_VIEW = """
visint: 1
name: one_view
about: The relief of one view, from its shading alone.
inputs: {image: Image, light: Light}
nodes:
  shape: {uses: shading.oliensis_dupuis, in: {image: inputs.image, light: inputs.light}}
  edges: {uses: grouping.canny, in: {image: inputs.image}}
outputs: {relief: shape.relief, normals: shape.normals, boundaries: edges.boundaries}
"""


def photographs(folder):
    place = DATA / "mb2014q/Motorcycle"
    if not place.is_dir():
        pytest.skip(f"there is no {place}")
    left, right = (io.read_color(place / f"{side}.png") for side in ("left", "right"))
    result = visint.run("stereo_sgm", left=left, right=right, camera=io.read_camera(place / "calib.txt"))
    result.save(folder)


def rendered(folder):
    """Compared with the matcher alone."""
    pair = render(sphere_before_plane(size=128, seed=0))
    inputs = {"left": pair.left, "right": pair.right, "camera": pair.camera}
    visint.run("stereo_sgm", inputs).save(folder / "before")
    visint.run("grouping", inputs).save(folder / "now", against=folder / "before")
    return folder / "now"


def one_view(folder):
    pair = render(scene("a/sphere/lambertian", size=128))
    (folder.parent / "one_view.yaml").write_text(ONE_VIEW)
    visint.run(folder.parent / "one_view.yaml", image=pair.left, light=pair.light).save(folder)


@pytest.fixture(scope="module", params=[photographs, rendered, one_view], ids=lambda make: make.__name__)
def saved(request, tmp_path_factory):
    """The file of a report."""
    folder = tmp_path_factory.mktemp(request.param.__name__) / "out"
    return (request.param(folder) or folder) / "report.html"


@pytest.fixture
def opened(browser, saved, surface):
    browser.get_log("browser")
    browser.get(saved.as_uri())
    surface.drawn(browser)
    return browser


def test_the_file_is_small_enough(saved):
    assert saved.stat().st_size < MOST_BYTES


def test_the_console_is_silent(opened):
    assert opened.get_log("browser") == []


def test_the_surface_is_not_blank(opened, surface):
    picture = surface.seen(opened)
    off = np.abs(picture - picture[0, 0]).sum(axis=-1) > 12
    assert 0.03 < off.mean() < 0.9


def test_a_slider_moves(opened):
    from selenium.webdriver.common.keys import Keys

    slider = opened.find_element("css selector", "[data-over] input[type=range]")
    before = slider.get_attribute("value")
    slider.send_keys(Keys.ARROW_LEFT * 5)
    assert int(slider.get_attribute("value")) == int(before) - 5


def test_every_picture_is_shown(opened):
    sizes = opened.execute_script("return [...document.images].map(i => [i.naturalWidth, i.clientWidth])")
    assert all(min(lengths) > 0 for lengths in sizes)
