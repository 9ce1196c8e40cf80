"""The report in a real browser: every picture shown, no word on the console, light and dark, by keyboard."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import visint
import visint.testing.plugin
from visint.graph import parse_graph
from visint.hookspecs import hookimpl
from visint.registry import Catalog
from visint.results.against import Against
from visint.results.report import report
from visint.testing.samples import sample_camera

GRAPH = """
visint: 1
name: seen
about: A toy hub, so that every section has something to show.
inputs: {left: Image, right: Image, camera: Camera}
loops:
  levels: {over: pyramid, coarsest: 16}
  sweeps: {inside: levels, times: 9, until: {change_of: map.depth, below: 1.0e-3}}
nodes:
  one: {uses: toy.constant}
  said: {uses: toy.warn, in: {value: one.value}}
  measured: {uses: toy.measure, in: {value: said.value}}
hub:
  uses: toy.even
  loop: sweeps
  start: {depth: plane, boundaries: none}
  order: [edges, shade, match]
  spokes:
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}}
    shade: {uses: toy.cue, in: {image: inputs.left}, with: {near: 700.0, far: 900.0}}
    match: {uses: toy.disparity_cue, in: {image: inputs.right}}
outputs: {depth: map.depth, boundaries: map.boundaries, regions: map.regions, count: measured.value}
"""

PARTS = """
const figures = [...document.querySelectorAll('figure[data-over]')];
return figures.map(f => [f.dataset.over, !!f.querySelector('.under')]);
"""

CONTRASTS = """
const light = c => c.match(/[\\d.]+/g).slice(0, 3).map(v => v / 255)
  .map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
  .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
const ground = e => {
  const c = getComputedStyle(e).backgroundColor;
  return c === 'rgba(0, 0, 0, 0)' && e.parentElement ? ground(e.parentElement) : c;
};
return ['h1', 'h2', '.about', 'dt', 'nav a', 'figcaption span', 'caption', 'td', '#warnings li',
        '#warnings small', 'summary', 'footer p'].map(where => {
  const e = document.querySelector(where);
  const [a, b] = [light(getComputedStyle(e).color), light(ground(e))].sort((x, y) => y - x);
  return [where, (a + 0.05) / (b + 0.05)];
});
"""


DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 128 96" onload="document.title=1">'
    '<script>parent.document.title = "ran"</script><path d="M9 9L99 80" stroke="red"/></svg>'
)


class Draws:
    """A plugin whose writer draws, in bad faith."""

    visint_contract = 1

    @hookimpl
    def visint_writers(self):
        return {"Scalar": lambda name, value: {f"{name}.svg": DRAWING.encode()}}


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The address of the report of a toy run, compared with itself less a little."""
    y, x = np.mgrid[:96, :128].astype(np.float32)
    image = np.where((x - 64) ** 2 + (y - 48) ** 2 < 900, 0.8, 0.3 + x / 512).astype(np.float32)
    catalog = Catalog({"toy": visint.testing.plugin, "pen": Draws()}, {})
    catalog.plugin("pen")
    graph = parse_graph(GRAPH, catalog)
    result = visint.run(graph, left=image, right=image, camera=sample_camera(image.shape))
    other = {"depth": ("Depth", result["depth"] - x / 100)}
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(report(result, Against("before", "seen", other, {})), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(params=["light", "dark"])
def shown(request, browser, page, surface):
    """The browser with the report open, in light and in dark."""
    scheme = {"name": "prefers-color-scheme", "value": request.param}
    still = {"name": "prefers-reduced-motion", "value": "reduce"}  # a click waits for no scrolling
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme, still]})
    browser.get_log("browser")  # what an earlier page had to say
    browser.get(page)
    surface.drawn(browser)
    browser.scheme = request.param
    return browser


def test_every_picture_is_shown(shown):
    """Each is decoded and takes up room."""
    sizes = shown.execute_script(
        "return [...document.images].map(i => [i.complete, i.naturalWidth, i.clientWidth, i.clientHeight])"
    )
    assert len(sizes) > 15
    assert all(done and min(lengths) > 0 for done, *lengths in sizes)


def test_the_console_is_silent_and_nothing_is_asked_for(shown):
    assert shown.get_log("browser") == []
    asked = shown.execute_script("return performance.getEntriesByType('resource').map(e => e.name.slice(0, 5))")
    assert set(asked) <= {"data:"}


def test_text_stands_out_in_both_schemes(shown):
    """Contrast of at least 4.5 (WCAG 2.2, 1.4.3), dark on light or light on dark as asked."""
    contrasts = shown.execute_script(CONTRASTS)
    assert {where: ratio for where, ratio in contrasts if ratio < 4.5} == {}
    ground = shown.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, ground[4:-1].split(","))) < 384) == (shown.scheme == "dark")


def test_it_fits_a_narrow_window(shown):
    """On a telephone only tables and code scroll sideways."""
    metrics = {"width": 360, "height": 740, "deviceScaleFactor": 1, "mobile": False}
    shown.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    try:
        assert shown.execute_script("return document.documentElement.scrollWidth") <= 360
    finally:
        shown.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_the_keyboard_reaches_everything(shown):
    """The first stop skips to the report; the graph opens with Enter."""
    from selenium.webdriver.common.keys import Keys

    shown.switch_to.active_element.send_keys(Keys.TAB)
    first = shown.switch_to.active_element
    assert first.text == "Skip to the report"
    first.send_keys(Keys.ENTER)
    assert shown.execute_script("return document.activeElement.id") == "main"
    shown.execute_script("document.querySelector('summary').focus()")
    shown.switch_to.active_element.send_keys(Keys.ENTER)
    assert shown.execute_script("return document.querySelector('details').open")


def test_the_surface_is_drawn(shown, surface):
    """It covers a fair part of its canvas, in more than a few tones, on the page's ground."""
    picture = surface.seen(shown)
    ground = picture[0, 0]
    assert (ground.sum() < 384) == (shown.scheme == "dark")
    off = np.abs(picture - ground).sum(axis=-1) > 12
    assert 0.03 < off.mean() < 0.9
    assert picture[off][:, 0].std() > 10


def test_the_surface_turns_by_keyboard_and_mouse(shown, surface):
    """Arrows, plus, a drag: each changes the picture; 0 brings the first back."""
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    canvas = shown.find_element("css selector", ".surface canvas")
    shown.execute_script("arguments[0].focus()", canvas)
    first = surface.seen(shown)
    acts = {
        "arrow": lambda: canvas.send_keys(Keys.ARROW_RIGHT),
        "plus": lambda: canvas.send_keys("+"),
        "drag": lambda: ActionChains(shown).drag_and_drop_by_offset(canvas, 60, 20).perform(),
        "normals": lambda: shown.find_element("css selector", ".tools input[value='2']").click(),
    }
    for name, act in acts.items():
        before, count = surface.seen(shown), surface.drawn(shown)
        act()
        surface.drawn(shown, count + 1, name)
        assert np.abs(surface.seen(shown) - before).mean() > 0.1, name
    shown.find_element("css selector", ".tools input[value='0']").click()
    shown.execute_script("arguments[0].focus()", canvas)
    canvas.send_keys("0")
    assert np.abs(surface.seen(shown) - first).mean() < 0.1


def test_sliders_move(shown):
    """Maps lie over the photograph: the slider of one hides a part of it, the one of lines fades the view."""
    from selenium.webdriver.common.keys import Keys

    parts = shown.execute_script(PARTS)
    assert parts.count(["swipe", True]) >= 2
    assert ["fade", True] in parts
    for kind, read in (("swipe", "i.style.clipPath"), ("fade", "i.previousSibling.style.opacity")):
        script = f"const i = document.querySelector('[data-over={kind}] .stack img:last-child'); return {read}"
        before = shown.execute_script(script)
        slider = shown.find_element("css selector", f"[data-over={kind}] input[type=range]")
        assert slider.get_attribute("aria-label")
        slider.send_keys(Keys.ARROW_LEFT * 9)
        assert shown.execute_script(script) != before


def test_a_drawing_lies_over_the_photograph_and_runs_nothing(shown):
    """Its script and its handler stay pictures."""
    figure = shown.find_element("css selector", ".drawing")
    assert figure.find_elements("css selector", ".under")
    assert shown.title == "seen – visint report"


def test_without_a_script_all_the_rest_is_there(browser, page, tmp_path):
    """The page with its script taken out: every picture is shown, and the surface says what it needs."""
    whole = Path(page.removeprefix("file://")).read_text()
    bare = tmp_path / "bare.html"
    bare.write_text(re.sub(r"<script>.*</script>", "", whole, flags=re.DOTALL))
    browser.get(bare.as_uri())
    assert "WebGL" in browser.find_element("css selector", ".surface").text
    sizes = browser.execute_script("return [...document.images].map(i => [i.naturalWidth, i.clientWidth])")
    assert all(min(lengths) > 0 for lengths in sizes)
    assert browser.get_log("browser") == []
