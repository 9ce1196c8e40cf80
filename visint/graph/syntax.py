"""What a YAML parser says about a broken file, turned into a sentence that helps."""

from __future__ import annotations

from typing import Any

from visint.errors import Problem, Where

__all__ = ["not_well_formed"]

_MEANT: tuple[tuple[str, str, str], ...] = (
    (
        "mapping values are not allowed",
        "a second ':' in one line, or one key too far in",
        'key: "text: with colon"',
    ),
    ("'\\t' that cannot start", "a tab; files are indented by blanks", "  key: value"),
    ("expected ',' or '}'", "a '{' is not closed, or a ',' is missing", "{key: value, key: value}"),
    ("expected ',' or ']'", "a '[' is not closed, or a ',' is missing", "[value, value]"),
    ("found unexpected end of stream", "a quote is not closed", '"text"'),
    ("could not find expected ':'", "a line that is neither 'key: value' nor a part of one", "key: value"),
    ("expected <block end>", "a line that is indented unlike its neighbours", "  key: value"),
    ("expected the node content", "a value is missing here", "key: value"),
    ("cannot start any token", "a character that no value may start with, unless quoted", '"@text"'),
    ("escape", "an escape that there is not", '"\\u00e9"'),
    ("incompatible YAML", "a version of YAML that there is not", "visint: 1   (no %YAML line is needed)"),
)


def not_well_formed(error: Any, file: str) -> Problem:
    """The problem behind ``error``, whatever the parser raised; always with a line."""
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    spot = Where(file, mark.line + 1, mark.column + 1) if mark else Where(file, 1, 1)
    said = " ".join(str(getattr(error, "problem", None) or error).split())[:120]
    for sign, meant, write in _MEANT:
        if sign in said:
            return Problem("VI102", f"not well-formed YAML: {meant}{_opened(error, mark)}", spot, write=write)
    return Problem("VI102", f"not well-formed YAML: {said}", spot, write="key: value")


def _opened(error: Any, mark: Any) -> str:
    """Where the thing began that does not end, if that is another place."""
    context = getattr(error, "context_mark", None)
    if context is None or mark is None or (context.line, context.column) == (mark.line, mark.column):
        return ""
    return f"; it began in line {context.line + 1}, column {context.column + 1}"
