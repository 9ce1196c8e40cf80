"""A real browser without a window and without a network, and what it shows of a report's surface."""

from __future__ import annotations

import base64
import shutil
import time
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)


@pytest.fixture(scope="session")
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


def drawn(browser, least=1, after="the page was opened"):
    """Waits until the surface was drawn ``least`` times; how often it was."""
    script = "return Number(document.querySelector('.surface canvas')?.dataset.drawn || 0)"
    end = time.monotonic() + 20
    while (count := browser.execute_script(script)) < least:
        told = browser.execute_script("return document.querySelector('.surface').innerText")
        assert time.monotonic() < end, f"not drawn after {after}: {told}"
        time.sleep(0.05)
    return count


def seen(browser):
    """The surface as it was drawn last, RGB."""
    url = browser.execute_script("return document.querySelector('.surface canvas').toDataURL('image/png')")
    png = np.frombuffer(base64.b64decode(url.partition(",")[2]), np.uint8)
    return cv2.imdecode(png, cv2.IMREAD_COLOR)[..., ::-1].astype(int)


@pytest.fixture(scope="session")
def surface():
    """Functions of the browser: how often the surface was ``drawn``, and the picture ``seen``."""
    return SimpleNamespace(drawn=drawn, seen=seen)
