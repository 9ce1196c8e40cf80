"""The output folder of a run: staged out of sight, moved into place when all of it is there."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import secrets
import shutil
import signal
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self

from visint.errors import InputError, OutputError
from visint.io import faults
from visint.io.files import shown
from visint.io.text import read_json
from visint.io.write import existing_ancestor, sync_folder, told, write_bytes

__all__ = ["RECORD", "OutputFolder", "former_files", "is_run"]

RECORD = "run.json"
"""The run record: a JSON object with the keys ``visint`` (its version) and ``files`` (the run's file names)."""

_HIDDEN = ".visint-"
_FORMER = "former"
_TAKEN = (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR)


class OutputFolder:
    """The folder that a run's files go into: all of them, or none.

    ::

        with OutputFolder("out") as folder:
            folder.write("depth.pfm", data)
            folder.write("run.json", record)

    The files are written to a hidden folder on the same disk. If the block ends well they are moved into
    place, the record last; after an exception, Ctrl-C included, the folder is as it was before. Over a
    former run, that run's files go away; files that no run wrote stay.

    Parameters
    ----------
    path
        Missing, empty, or holding a visint run; its parents are made where needed.
    force
        Take a folder that holds other things. They stay, unless a new file has the same name.

    Raises
    ------
    OutputError
        VI602, already when made, if the folder is refused; VI601 if it cannot be written to, or if another
        run is writing into it.
    """

    def __init__(self, path: str | Path, *, force: bool = False) -> None:
        self.path = Path(path)
        self.force = force
        self._stage: Path | None = None
        self._names: list[str] = []
        self._locks = contextlib.ExitStack()
        with told(self.path):
            self.path = self.path.resolve()
            self._check()

    @property
    def files(self) -> tuple[str, ...]:
        """The names written so far, in order."""
        return tuple(self._names)

    def __enter__(self) -> Self:
        """Make the hidden folder: beside a folder that is missing, inside one that exists."""
        try:
            with told(self.path):
                self._open()
        except BaseException:
            self._discard()
            raise
        return self

    def write(self, name: str, data: bytes) -> None:
        """Add a file; nobody sees it before the block ends.

        Raises
        ------
        OutputError
            VI601 if it cannot be written, or if ``name`` is more or less than a plain file name.
        """
        if self._stage is None:
            raise RuntimeError("write within the block: with OutputFolder(...) as folder")
        if not _plain(name):
            raise OutputError.of("VI601", "is no plain file name; wants one like depth.pfm", where=shown(name))
        write_bytes(self._stage / name, data)
        if name not in self._names:
            self._names.append(name)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Move everything into place, or leave no trace."""
        try:
            if kind is None:
                with _uninterrupted(), told(self.path):
                    self._commit()
        finally:
            self._discard()

    def _open(self) -> None:
        if self.path.is_dir():
            self._lock()
            for stale in self.path.glob(f"{_HIDDEN}*"):  # a killed run's; whoever writes holds the lock
                shutil.rmtree(stale, ignore_errors=True)
        home = existing_ancestor(self.path)
        stage = home / f"{_HIDDEN}{secrets.token_hex(6)}"
        faults.step("folder")
        stage.mkdir()
        self._stage = stage

    def _lock(self) -> None:
        handle = os.open(self.path, os.O_RDONLY)
        self._locks.callback(os.close, handle)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            found = "another run is writing into this folder; wait for it or choose another one"
            raise OutputError.of("VI601", found, where=shown(self.path)) from None

    def _check(self) -> None:
        nearest = next(place for place in (self.path, *self.path.parents) if place.exists())
        if not nearest.is_dir():
            raise OutputError.of("VI602", "is a file; wants a folder", where=shown(nearest))
        if nearest != self.path:
            return
        others = [entry for entry in self.path.iterdir() if not entry.name.startswith(_HIDDEN)]
        if others and not self.force and not is_run(self.path):
            raise OutputError.of(
                "VI602",
                "is not empty and holds no visint run; wants a new or empty folder, or a former run's",
                where=shown(self.path),
                write="--force (what is in it stays, unless a new file has the same name)",
            )

    def _commit(self) -> None:
        assert self._stage is not None
        if not self._stage.is_relative_to(self.path) and self._renamed():
            return
        if not self._stage.is_relative_to(self.path):  # someone made the folder meanwhile
            self._lock()
            self._check()
        _all_or_none(self._moves(self._stage))
        sync_folder(self.path)

    def _renamed(self) -> bool:
        """Whether the hidden folder could simply take the name: one step, nothing in between."""
        assert self._stage is not None
        faults.step("folder")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            faults.step("rename")
            self._stage.rename(self.path)
        except OSError as error:
            if error.errno in _TAKEN:
                return False
            raise
        sync_folder(self.path.parent)
        return True

    def _moves(self, stage: Path) -> list[tuple[Path, Path]]:
        """Old files out, the record first; new files in, the record last."""
        new = sorted(self._names, key=lambda name: name == RECORD)
        gone = [name for name in former_files(self.path) if name not in new]
        out = [name for name in (RECORD, *gone, *new) if (self.path / name).is_file()]
        former = stage / _FORMER
        faults.step("folder")
        former.mkdir()
        moves = [(self.path / name, former / name) for name in dict.fromkeys(out)]
        return moves + [(stage / name, self.path / name) for name in new]

    def _discard(self) -> None:
        if self._stage is not None:
            shutil.rmtree(self._stage, ignore_errors=True)
            self._stage = None
        self._locks.close()


def is_run(folder: Path) -> bool:
    """Whether ``folder`` holds a run that visint wrote, or one that was killed while moving into place."""
    return _record(folder) is not None or any(folder.glob(f"{_HIDDEN}*/{_FORMER}"))


def former_files(folder: Path) -> tuple[str, ...]:
    """The files that the run record in ``folder`` calls its own: plain names of existing files alone."""
    named = (_record(folder) or {}).get("files", [])
    names = named if isinstance(named, list) else []
    return tuple(n for n in names if isinstance(n, str) and _plain(n) and (folder / n).is_file())


def _record(folder: Path) -> dict[str, object] | None:
    try:
        record = read_json(folder / RECORD)
    except InputError:
        return None
    return record if isinstance(record, dict) and "visint" in record else None


def _plain(name: str) -> bool:
    return bool(name) and not name.startswith(".") and not set(name) & set("/\\\0") and len(name.encode()) < 256


def _all_or_none(moves: Iterable[tuple[Path, Path]]) -> None:
    """Rename all; if one fails, rename those already done back."""
    done: list[tuple[Path, Path]] = []
    try:
        for source, goal in moves:
            faults.step("rename")
            source.rename(goal)
            done.append((source, goal))
    except BaseException:
        for source, goal in reversed(done):
            goal.rename(source)
        raise


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back until the few renames inside are done."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    caught: list[int] = []
    former = signal.signal(signal.SIGINT, lambda number, _frame: caught.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL if former is None else former)
        if caught:
            signal.raise_signal(signal.SIGINT)
