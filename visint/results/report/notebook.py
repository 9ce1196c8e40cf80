"""What a notebook shows of a value: small pictures in a row, and the whole report in a frame."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any

import numpy as np

from visint import io
from visint.fields.evidence import Evidence
from visint.fields.snapshot import MapSnapshot
from visint.results.report.legends import gradients
from visint.results.report.maps import Map, figure, is_map
from visint.results.report.markup import Markup, element, joined
from visint.results.report.numbers import seconds
from visint.results.report.page import report

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["Shown", "html_of", "show"]

_SIDE = 320
_STYLE = """
.visint-cell{display:flex;flex-wrap:wrap;gap:12px;font:13px/1.4 system-ui,sans-serif}
.visint-cell figure{margin:0;width:220px}
.visint-cell img{width:100%;height:auto}
.visint-cell .key img{width:24px}
.visint-cell .bar svg{width:100%;height:8px}
.visint-cell .bar div{display:flex;justify-content:space-between}
.visint-cell .swatch{display:inline-block;width:10px;height:10px;border:1px solid #888}
.visint-cell .swatch.unknown{background:#808080}
.visint-cell p{margin:2px 0;width:100%}
"""
_HEIGHT = 640


class Shown:
    """The report of a run, in a frame of a notebook; :attr:`path` is its file where one was opened."""

    def __init__(self, page: str, path: Path | None = None) -> None:
        self.page = page
        self.path = path

    def _repr_html_(self) -> str:
        """The report in a frame of its own: its script runs there and reaches nothing outside."""
        page = escape(self.page, quote=True)
        style = f"width:100%;height:{_HEIGHT}px;border:1px solid #8888"
        return (
            f'<iframe sandbox="allow-scripts" title="visint report" style="{style}" srcdoc="{page}"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<Shown at {self.path}>" if self.path else "<Shown>"


def show(result: Result, *, against: str | Path | None = None) -> Shown:
    """The report of ``result``: in a notebook as the value of a cell, elsewhere in the web browser.

    Parameters
    ----------
    result
        What :func:`visint.run` gave. Nothing is saved but, outside a notebook, the page itself, into a new
        temporary folder.
    against
        The folder of another run to compare with.

    Raises
    ------
    InputError
        If the other run cannot be read.
    """
    from visint.results.against import read_against

    page = report(result, None if against is None else read_against(against))
    if _in_notebook():
        return Shown(page)
    path = Path(mkdtemp(prefix="visint-")) / "report.html"
    io.write_text(path, page)
    webbrowser.open(path.as_uri())
    return Shown(page, path)


def _in_notebook() -> bool:
    """Whether a kernel is at work that shows the value of a cell."""
    import sys

    interactive = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(interactive, "kernel")


def html_of(value: Any) -> str:
    """A result, evidence or a map as a row of small pictures, each with what its colours mean."""
    pictures: Callable[[Any], Iterator[Markup]] = _result
    if isinstance(value, Evidence):
        pictures = _evidence
    elif isinstance(value, MapSnapshot):
        pictures = _snapshot
    return element("div", element("style", Markup(_STYLE)), gradients(), *pictures(value), class_="visint-cell")


def _picture(title: str, kind: str, value: Any, unit: str) -> Markup:
    return figure(Map(title, kind, value, unit), _SIDE)


def _evidence(said: Evidence, unit: str = "1") -> Iterator[Markup]:
    yield _picture("value", said.measures, said.value, unit)
    yield _picture("sigma", "Sigma", said.sigma, unit)
    yield _picture("reliability", "Confidence", said.reliability, "1")


def _snapshot(snapshot: MapSnapshot) -> Iterator[Markup]:
    for name, value in snapshot.values.items():
        if is_map(value):
            kind = snapshot.kinds[name]
            unit = snapshot.camera.unit if kind.name == "Depth" else "1"
            yield _picture(name, kind.name, value, unit)
        sure = snapshot.confidence.get(name)
        if isinstance(sure, np.ndarray):
            yield _picture(f"confidence of {name}", "Confidence", sure, "1")


def _result(result: Result) -> Iterator[Markup]:
    from visint.results.report.setting import Setting

    setting = Setting(result, _SIDE)
    words = [f"{result.graph.name}: {seconds(result.seconds)}", *_warned(result)]
    yield joined(element("p", text) for text in words)
    for name, value in setting.maps().items():
        yield setting.figure(name, result.kinds[name], value)
    others = [name for name in result.outputs if name not in setting.maps()]
    if others:
        yield element("p", "no maps: " + ", ".join(f"{name} = {result[name]!r:.60}" for name in others))


def _warned(result: Result) -> list[str]:
    said = dict.fromkeys(f"{warned.node}: {warned.text}" for warned in result.warnings)
    return [f"warning: {text}" for text in said]
