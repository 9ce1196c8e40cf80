"""What is refused before a graph file is parsed: it is untrusted, and parsing takes time by its form, not size.

No graph that a person wrote comes near these limits; the largest shipped one has some 400 values.
"""

from __future__ import annotations

import re

from visint.errors import GraphError, Problem, Where

__all__ = ["DEEPEST", "LARGEST", "LONGEST", "LONGEST_TEXT", "refuse_monsters"]

LARGEST = 1 << 18
"""Bytes of a file."""
LONGEST = 20_000
"""Values, and lines, of a file."""
DEEPEST = 24
"""Values inside each other."""
LONGEST_TEXT = 10_000
"""Characters of one text."""

_UNPRINTABLE = re.compile("[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
# Each is tried only where a run begins: else a file of long runs takes the square of its length.
_WORD = re.compile(r"(?<![^\s,:])[^\s,:]{1001}")
_BLANK = re.compile(r"(?<!\s)\s{2001}")
_TEXT = re.compile(r"(?<![^:,\[\]{}\n])[^:,\[\]{}\n]{10001}")
_RUNS = (
    (_WORD, "a word of more than 1000 letters"),
    (_BLANK, "a gap of more than 2000 blanks"),
    (_TEXT, f"a text of more than {LONGEST_TEXT} letters"),
)
_BRACKET = re.compile(r"[\[\]{}]")


def refuse_monsters(text: str, file: str) -> None:
    """Raises if ``text`` is too large, too deep or no text; takes a few ms whatever it is given.

    Raises
    ------
    GraphError
        VI102 for characters that are no text, VI107 for what is beyond the limits; with line and column.
    """
    if len(text) > LARGEST:
        raise _beyond(file, text, 0, f"more than {LARGEST // 1024} kB")
    if text.count("\n") > LONGEST:
        raise _beyond(file, text, 0, f"more than {LONGEST} lines")
    _refuse_depth(text, file)
    if sum(map(text.count, (":", ",", "[", "{", "- ", "? "))) > 2 * LONGEST:
        raise _beyond(file, text, 0, f"more than {LONGEST} values")
    odd = _UNPRINTABLE.search(text)
    if odd is not None:
        found = f"the character U+{ord(odd[0]):04X} has no place in a text file"
        raise GraphError(Problem("VI102", found, _spot(file, text, odd.start()), write="(the line without it)"))
    for pattern, what in _RUNS:
        long = pattern.search(text)
        if long is not None:
            raise _beyond(file, text, long.start(), what, "(a shorter text)")


def _refuse_depth(text: str, file: str) -> None:
    """Brackets in comments and quotes count here too: so the bound is wider than that of the parser."""
    depth = 0
    for bracket in _BRACKET.finditer(text):
        depth += 1 if bracket[0] in "[{" else -1
        if depth > 2 * DEEPEST:
            raise _beyond(file, text, bracket.start(), f"values nested deeper than {DEEPEST}")


def _beyond(
    file: str, text: str, at: int, what: str, write: str = "uses: graph:NAME   (parts in files of their own)"
) -> GraphError:
    found = f"{what}: more than a graph file may have"
    return GraphError(Problem("VI107", found, _spot(file, text, at), write=write))


def _spot(file: str, text: str, at: int) -> Where:
    return Where(file, text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at))
