"""Writing: a file is there whole, or as it was before. Every failure is one line."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import shutil
from collections.abc import Iterator
from pathlib import Path

from visint.errors import OutputError
from visint.io import faults
from visint.io.files import shown

__all__ = ["existing_ancestor", "make_folder", "sync_folder", "told", "write_bytes", "write_text"]

_FULL = (errno.ENOSPC, errno.EDQUOT)
_REASONS = {
    errno.EACCES: "permission denied; wants a folder that you may write to",
    errno.EPERM: "permission denied; wants a folder that you may write to",
    errno.EROFS: "the disk is read-only; wants a folder on another one",
    errno.ENOENT: "its folder does not exist; create it first",
    errno.ENOTDIR: "a part of its path is a file, not a folder",
    errno.EISDIR: "there is a folder of that name; wants a file name",
    errno.ENAMETOOLONG: "the name is too long",
    errno.EFBIG: "it is larger than this process or disk may write; raise the limit (ulimit -f)",
}


def write_bytes(path: str | Path, data: bytes) -> None:
    """Put a file in place whole: written beside it, flushed to disk, then renamed over it.

    Raises
    ------
    OutputError
        VI601, naming the file and what is missing; nothing is left behind, a former file stays as it was.
    """
    path = Path(path)
    with told(path, len(data)):
        temporary = path.with_name(f".visint-{secrets.token_hex(6)}.part")
        try:
            _put(temporary, data)
            faults.step("rename")
            temporary.replace(path)
        except BaseException:  # Ctrl-C too
            with contextlib.suppress(OSError):
                temporary.unlink()
            raise


def write_text(path: str | Path, text: str) -> None:
    """A UTF-8 text file, its line ends as in ``text``; as :func:`write_bytes`."""
    write_bytes(path, text.encode("utf-8"))


def make_folder(path: str | Path) -> None:
    """A folder, its parents where needed; one that is there is fine. OutputError VI601 where it cannot be."""
    path = Path(path)
    with told(path):
        faults.step("folder")
        path.mkdir(parents=True, exist_ok=True)


def _put(path: Path, data: bytes) -> None:
    faults.step("open")
    with path.open("xb") as file:
        faults.step("write")
        file.write(faults.cut(data))
        file.flush()
        faults.step("sync")
        os.fsync(file.fileno())
        if os.fstat(file.fileno()).st_size != len(data):
            raise OSError(errno.EIO, "fewer bytes arrived than were written")


def sync_folder(folder: Path) -> None:
    """Flush a folder's entries to disk, so that renames in it outlive a power cut."""
    faults.step("sync")
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextlib.contextmanager
def told(path: Path, size: int = 0) -> Iterator[None]:
    """Turn any OSError inside into an OutputError VI601 on ``path``, of which ``size`` bytes were wanted."""
    try:
        yield
    except (OSError, ValueError) as error:
        if isinstance(error, OSError) and error.errno in _FULL:
            reason = _full(path, size)
        elif isinstance(error, OSError):
            reason = _REASONS.get(error.errno or 0, error.strerror or type(error).__name__)
        else:
            reason = "that is no file name"
        raise OutputError.of("VI601", f"cannot be written: {reason}", where=shown(path)) from None


def _full(path: Path, size: int) -> str:
    free = 0
    with contextlib.suppress(OSError):
        free = shutil.disk_usage(existing_ancestor(path.absolute().parent)).free
    if free >= size:
        return f"the disk or quota is full; this file needs {_amount(size)}"
    missing = _amount(size - free)
    return f"the disk is full: {_amount(size)} wanted, {_amount(free)} free, {missing} missing"


def _amount(size: int) -> str:
    return f"{size} bytes" if size < 10_000 else f"{size / 1e6:.3g} MB"


def existing_ancestor(folder: Path) -> Path:
    """``folder``, or the nearest folder above it that exists."""
    return next((one for one in (folder, *folder.parents) if one.is_dir()), folder)
