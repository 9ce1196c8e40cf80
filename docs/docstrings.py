"""Docstrings in numpy's form as Markdown: text stays text, whatever signs are in it."""

from __future__ import annotations

import re

__all__ = ["parameters_in", "prose"]

_SIGNS = re.compile(r"([\\*_\[\]<>|$#~`])")
_CODE = re.compile(r"``(.+?)``|:\w+:`~?([^`]+)`", re.DOTALL)
_SECTION = re.compile(r"^Parameters\n-+\n", re.MULTILINE)


def prose(text: str) -> str:
    """Paragraphs on one line each, code as code; an indented paragraph is kept as it is."""
    return "\n\n".join(_paragraph(one) for one in re.split(r"\n\s*\n", text.strip("\n")) if one.strip())


def _paragraph(text: str) -> str:
    lines = text.splitlines()
    if all(line.startswith(" ") for line in lines):
        return "```text\n" + text + "\n```"
    items = re.split(r"\n(?=[*-] )", text)
    if len(items) > 1 or re.match(r"[*-] ", text):
        return "\n".join(f"* {_line(item[2:])}" if re.match(r"[*-] ", item) else _line(item) for item in items)
    return _line(text)


def _line(text: str) -> str:
    """One line: code between single backticks, every other sign escaped."""
    joined = " ".join(text.split())
    parts, last = [], 0
    for found in _CODE.finditer(joined):
        parts += [_SIGNS.sub(r"\\\1", joined[last : found.start()]), f"`{found[1] or found[2]}`"]
        last = found.end()
    return "".join([*parts, _SIGNS.sub(r"\\\1", joined[last:])]).replace("::", ":")


def parameters_in(text: str) -> dict[str, str]:
    """Name → description, as Markdown, of each parameter in the section on them; ``a, b`` names two."""
    parts = _SECTION.split(text)
    found: dict[str, str] = {}
    if len(parts) < 2:
        return found
    for names, about in re.findall(
        r"^(\w[\w, ]*?)(?: *:.*)?\n((?:[ ]{4}.*\n?|\n(?=[ ]{4}))+)", parts[1], re.MULTILINE
    ):
        for name in names.split(","):
            found[name.strip()] = _line(about)
    return found
