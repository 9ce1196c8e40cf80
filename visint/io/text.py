"""Text files: graph files, calibrations, JSON records."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from visint.errors import InputError
from visint.io.files import head_of, read_bytes, shown
from visint.io.formats import binary_sort
from visint.io.refusals import broken

__all__ = ["read_json", "read_text", "text_of"]

_MOST = 1 << 20


def read_text(path: str | Path, *, most: int = _MOST) -> str:
    """A UTF-8 text file, without its byte order mark; line ends as they are.

    Parameters
    ----------
    most
        The largest file read, bytes; 1 MB unless told.

    Raises
    ------
    InputError
        As :func:`visint.io.read_bytes`; VI302 if it is not UTF-8 text, with the line of the first bad byte.
    """
    try:
        data = read_bytes(path, most=most)
    except InputError as error:
        if error.problems[0].code == "VI303":  # what it is says more than how large it is
            _refuse_binary(head_of(path), shown(path))
        raise
    return text_of(data, shown(path))


def _refuse_binary(head: bytes, name: str) -> None:
    sort = binary_sort(head)
    if sort is not None:
        raise broken(name, f"is {sort}, not text")


def text_of(data: bytes, name: str) -> str:
    """The text in ``data``, named ``name`` in messages; raises as :func:`read_text`."""
    _refuse_binary(data[:16], name)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        found = f"is not UTF-8 text: byte 0x{data[error.start]:02x}; save it as UTF-8"
        raise broken(name, found, line=data.count(b"\n", 0, error.start) + 1) from None
    if "\0" in text:
        raise broken(name, "is not text: it has NUL bytes", line=text.count("\n", 0, text.index("\0")) + 1)
    return text


def read_json(path: str | Path, *, most: int = 64 * _MOST) -> Any:
    """What a JSON file says.

    Raises
    ------
    InputError
        As :func:`read_text`; VI302 with line and column if it is not JSON.
    """
    text = read_text(path, most=most)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise broken(shown(path), f"is not JSON: {error.msg}", line=error.lineno, column=error.colno) from None
    except (RecursionError, ValueError):  # ValueError: an integer of thousands of digits
        raise broken(shown(path), "is not JSON that can be read: too deep or with too long a number") from None
