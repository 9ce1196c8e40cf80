"""The report in a real browser: every picture shown, no word on the console, light and dark, by keyboard."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

import visint
import visint.testing.plugin
from visint.graph import parse_graph
from visint.registry import Catalog
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

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)

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


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    driver = shutil.which("chromedriver")
    if not (chromium and driver):
        pytest.skip("there is no Chromium with its driver on this machine")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(executable_path=driver)
    opened = webdriver.Chrome(options=options, service=service)
    yield opened
    opened.quit()


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The address of the report of a toy run."""
    y, x = np.mgrid[:96, :128].astype(np.float32)
    image = np.where((x - 64) ** 2 + (y - 48) ** 2 < 900, 0.8, 0.3 + x / 512).astype(np.float32)
    graph = parse_graph(GRAPH, Catalog({"toy": visint.testing.plugin}, {}))
    result = visint.run(graph, left=image, right=image, camera=sample_camera(image.shape))
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(report(result), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(params=["light", "dark"])
def shown(request, browser, page):
    """The browser with the report open, in light and in dark."""
    scheme = {"name": "prefers-color-scheme", "value": request.param}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    browser.get(page)
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
