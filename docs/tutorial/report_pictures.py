"""Makes the pictures of a report that the docs show.

``python docs/tutorial/report_pictures.py REPORT PICTURE [TOP]``: REPORT is a ``report.html``, PICTURE a
``.jpg``, TOP a section to begin at (``surface``, ``outputs``). Needs selenium, Chromium and its driver.
"""

from __future__ import annotations

import shutil
import sys
import time
from pathlib import Path

import cv2
import numpy as np
from selenium import webdriver

SIZE = (1180, 860)
FLAGS = ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def picture(report: Path, top: str) -> np.ndarray:
    """What a window of :data:`SIZE` shows of the report, from the section ``top`` on."""
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for flag in (*FLAGS, "--window-size={},{}".format(*SIZE)):
        options.add_argument(flag)
    service = webdriver.ChromeService(executable_path=shutil.which("chromedriver"))
    browser = webdriver.Chrome(options=options, service=service)
    try:
        browser.get(report.resolve().as_uri())
        time.sleep(2)
        browser.execute_script(
            "document.documentElement.style.scrollBehavior = 'auto';"
            "for (const s of document.querySelectorAll('.slider input'))"
            "  { s.value = 55; s.dispatchEvent(new Event('input')); }"
            "document.getElementById(arguments[0])?.scrollIntoView();",
            top,
        )
        time.sleep(1)
        return cv2.imdecode(np.frombuffer(browser.get_screenshot_as_png(), np.uint8), cv2.IMREAD_COLOR)
    finally:
        browser.quit()


if __name__ == "__main__":
    shot = picture(Path(sys.argv[1]), sys.argv[3] if len(sys.argv) > 3 else "")
    cv2.imwrite(sys.argv[2], cv2.resize(shot, None, fx=0.62, fy=0.62, interpolation=cv2.INTER_AREA))
