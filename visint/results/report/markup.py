"""HTML that cannot be injected into: whatever is not markup already is escaped."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence

__all__ = ["Markup", "Part", "element", "joined", "scrolling", "table"]

_VOID = frozenset({"img", "br", "rect", "line", "polyline", "circle", "stop"})


class Markup(str):
    """Text that is HTML already; made by :func:`element` and :func:`joined` only."""

    __slots__ = ()


Part = str | int | None
"""What an element holds: markup as it is, text to be escaped, numbers, or nothing."""


def _safe(part: Part) -> str:
    if part is None:
        return ""
    return part if isinstance(part, Markup) else html.escape(str(part))


def joined(parts: Iterable[Part]) -> Markup:
    """The parts one after the other, text escaped."""
    return Markup("".join(_safe(part) for part in parts))


def element(tag: str, *parts: Part, **attributes: str | float | None) -> Markup:
    """``<tag attributes>parts</tag>``, everything escaped.

    Attribute names are written ``class_`` for words of Python and ``aria_label`` for names with a hyphen;
    an attribute that is None is left out.
    """
    given = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{html.escape(str(value))}"'
        for name, value in attributes.items()
        if value is not None
    )
    if tag in _VOID:
        return Markup(f"<{tag}{given}>" if tag in ("img", "br") else f"<{tag}{given}/>")
    return Markup(f"<{tag}{given}>{joined(parts)}</{tag}>")


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[Part]]) -> Markup:
    """A table whose first column names its rows; ``caption`` says what it holds."""
    head = element("tr", *(element("th", one, scope="col") for one in heads))
    body = [
        element("tr", element("th", row[0], scope="row"), *(element("td", one) for one in row[1:]))
        for row in rows
    ]
    whole = element(
        "table", element("caption", caption), element("thead", head), element("tbody", joined(body))
    )
    return scrolling(caption, whole)


def scrolling(label: str, inside: Markup) -> Markup:
    """``inside``, scrolled sideways where it is too wide, by keyboard too."""
    return element("div", inside, class_="wide", tabindex=0, role="region", aria_label=label)
