"""Files as bytes: opened, read whole, named in messages. Every failure is one line."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Callable
from itertools import islice
from pathlib import Path

from visint.errors import InputError
from visint.io.limits import LIMITS
from visint.names import did_you_mean

__all__ = ["Note", "digest", "files_in", "head_of", "read_bytes", "shown", "silent"]

Note = Callable[[str], None]
"""Told in one sentence what reading changed on the way: alpha dropped, rounded to float32."""

_REASONS = {
    errno.ENOENT: "no such file",
    errno.ENOTDIR: "no such file: a part of its path is a file, not a folder",
    errno.EACCES: "may not be read: permission denied",
    errno.EPERM: "may not be read: permission denied",
    errno.ENAMETOOLONG: "no such file: the name is too long",
    errno.ELOOP: "no such file: its links lead round in a circle",
}


def silent(note: str) -> None:
    """The :data:`Note` that nobody hears."""


def shown(path: str | Path) -> str:
    """A path for a message: on one line and encodable, whatever characters its name has."""
    text = os.fspath(path)
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def read_bytes(path: str | Path, *, most: int = LIMITS.most_bytes) -> bytes:
    """The whole file.

    Parameters
    ----------
    path
        A regular file or a link to one; devices and pipes are refused, for they may never end.
    most
        The largest file read, bytes.

    Raises
    ------
    InputError
        VI301 if it is missing, a folder or unreadable; VI302 if it is empty; VI303 if it is too large.
    """
    try:
        if _refuse_odd(path) > most:  # by its size alone: nothing is read, nothing allocated
            found = f"is larger than the {most / (1 << 20):.4g} MB that are read of such a file"
            raise InputError.of("VI303", found, where=shown(path))
        data = Path(path).read_bytes()
    except (OSError, ValueError) as error:
        raise _missing(path, error) from None
    if not data:
        raise InputError.of("VI302", "is empty", where=shown(path))
    return data


def head_of(path: str | Path) -> bytes:
    """The first bytes of the file, by which its format is told; raises as :func:`read_bytes` does."""
    try:
        _refuse_odd(path)
        with Path(path).open("rb") as file:
            return file.read(16)
    except (OSError, ValueError) as error:
        raise _missing(path, error) from None


def digest(path: str | Path) -> str:
    """SHA-256 of the file in hexadecimal, whatever its size; raises as :func:`read_bytes` does."""
    try:
        _refuse_odd(path)
        with Path(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError) as error:
        raise _missing(path, error) from None


def files_in(folder: str | Path, *suffixes: str) -> tuple[Path, ...]:
    """The files in ``folder`` that end in one of ``suffixes`` (any file if none is given), by name.

    Raises
    ------
    InputError
        VI301 if the folder is missing or cannot be listed.
    """
    try:
        found = sorted(Path(folder).iterdir())
    except (OSError, ValueError) as error:
        raise _missing(folder, error) from None
    return tuple(file for file in found if file.is_file() and (not suffixes or file.suffix in suffixes))


def _refuse_odd(path: str | Path) -> int:
    """The size of a regular file. Asked before opening: opening a pipe would wait for a writer."""
    status = Path(path).stat()
    if stat.S_ISDIR(status.st_mode):
        raise InputError.of("VI301", "is a folder; wants a file", where=shown(path))
    if not stat.S_ISREG(status.st_mode):
        raise InputError.of("VI301", "is a device or a pipe; wants a regular file", where=shown(path))
    return status.st_size


def _missing(path: str | Path, error: OSError | ValueError) -> InputError:
    if isinstance(error, ValueError):  # a NUL in the name
        return _refused(path, "no such file: the name has a character that no file name has")
    reason = _REASONS.get(error.errno or 0, f"cannot be read: {error.strerror}")
    near = _nearest(Path(path)) if error.errno == errno.ENOENT else None
    return _refused(path, reason, f"the folder has {near!r}" if near else "")


def _refused(path: str | Path, found: str, choices: str = "") -> InputError:
    error = InputError.of("VI301", found, where=shown(path), choices=choices)
    assert isinstance(error, InputError)
    return error


def _nearest(path: Path) -> str | None:
    try:
        return did_you_mean(path.name, (entry.name for entry in islice(path.parent.iterdir(), 1000)))
    except OSError:
        return None
