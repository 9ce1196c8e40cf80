"""Legends: what the colours of a picture mean."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.results import pictures
from visint.results.report.embed import embedded
from visint.results.report.markup import Markup, Part, element, joined
from visint.results.report.numbers import number, with_unit

__all__ = ["change_bar", "color_bar", "gradients", "grey_bar", "key", "normals_key"]

_STOPS = 17


def gradients() -> Markup:
    """What bars are filled with, once a page."""
    levels = np.linspace(0, 255, _STOPS).astype(np.uint8)[None]
    colors = ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in pictures.turbo(levels)[0]]
    fills = {"turbo": colors, "grey": ["#000", "#fff"], "change": ["#2166ac", "#fff", "#b2182b"]}
    drawn = [_gradient(name, stops) for name, stops in fills.items()]
    return element("svg", *drawn, width=0, height=0, class_="hidden", aria_hidden="true")


def _gradient(name: str, colors: list[str]) -> Markup:
    last = len(colors) - 1
    stops = [element("stop", offset=f"{i / last:.4g}", stop_color=color) for i, color in enumerate(colors)]
    return element("linearGradient", *stops, id=name)


def color_bar(low: float, high: float, unit: str) -> Markup:
    """The turbo colours from ``low`` to ``high``."""
    ends = (with_unit(number(low), unit), with_unit(number(high), unit))
    middle = number((low + high) / 2)
    return _bar("turbo", (ends[0], middle, ends[1]), "Colour bar: blue is {}, red is {}")


def grey_bar() -> Markup:
    """Grey from 0, black, to 1, white."""
    return _bar("grey", ("0", "0.5", "1"), "Grey bar: black is {}, white is {}")


def change_bar(most: float, unit: str) -> Markup:
    """From −``most``, blue, over 0, white, to ``most``, red."""
    ends = with_unit(number(-most), unit), with_unit(number(most), unit)
    return _bar("change", (ends[0], "0", ends[1]), "Colour bar: blue is {}, red is {}")


def _bar(fill: str, ticks: tuple[str, str, str], says: str) -> Markup:
    drawn = element(
        "svg",
        element("rect", width=100, height=8, fill=f"url(#{fill})"),
        viewBox="0 0 100 8",
        preserveAspectRatio="none",
        role="img",
        aria_label=says.format(ticks[0], ticks[2]),
    )
    return element("div", drawn, element("div", *(element("span", tick) for tick in ticks)), class_="bar")


def key(entries: dict[str, str]) -> Markup:
    """Swatches: class of the swatch → what it means."""
    each = [_entry(element("span", class_=f"swatch {name}"), says) for name, says in entries.items()]
    return element("p", *each, class_="key")


def _entry(swatch: Markup, says: Part) -> Markup:
    return element("span", swatch, joined([" ", says]))


def normals_key(unknown: bool) -> Markup:
    """A ball as the camera would see it, in the colours of its normals."""
    ball = embedded(pictures.of_normals(_ball(48)), "Key: a ball in the colours of its normals", 48)
    says = "red faces right, green up, blue the camera"
    return element(
        "p",
        element("span", ball, " ", says, class_="ball"),
        _entry(element("span", class_="swatch unknown"), "unknown") if unknown else None,
        class_="key",
    )


def _ball(size: int) -> Array:
    """Normals float32 (size, size, 3) of a ball that fills the picture; NaN around it."""
    x, y = np.meshgrid(*[np.linspace(-1, 1, size, dtype=np.float32)] * 2)
    with np.errstate(invalid="ignore"):
        z = -np.sqrt(1 - x * x - y * y)
    return np.where(np.isnan(z)[..., None], np.float32(np.nan), np.stack([x, y, z], axis=-1))
