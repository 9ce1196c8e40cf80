"""Watching what a piece of code does to the world: files, sockets, processes, imports, global state."""

from __future__ import annotations

import builtins
import os
import random
import sys
import sysconfig
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["HEAVY", "global_state", "imports", "world"]

HEAVY = frozenset({"cv2", "dask", "matplotlib", "networkx", "numba", "scipy", "skimage", "sklearn", "torch"})
"""Packages that take long to import: wanted inside ``run``, not before."""

_EVENTS = (
    "open",
    "os.",
    "shutil.",
    "socket.",
    "subprocess.",
    "tempfile.",
    "urllib.",
    "sqlite3.",
    "ftplib.",
    "http.",
    "mmap.",
)
_HARMLESS = ("os.listdir", "os.scandir", "os.fwalk", "os.walk", "os.putenv", "os.unsetenv")
_CODE = (".py", ".pyc", ".so", ".pyd", ".nbi", ".nbc")
_watching: list[list[str]] = []


def _hook(event: str, args: tuple[Any, ...]) -> None:
    if _watching and event.startswith(_EVENTS) and event not in _HARMLESS and not _allowed(event, args):
        _watching[-1].append(f"{event}({', '.join(repr(arg) for arg in args[:2])})")


def _allowed(event: str, args: tuple[Any, ...]) -> bool:
    """Importing, numba's cache, and what a library reads of its own installation or of the machine."""
    touched = [os.fspath(arg) for arg in args if isinstance(arg, str | os.PathLike)]
    if any(".nbi" in path or ".nbc" in path or "__pycache__" in path for path in map(str, touched)):
        return True
    if event != "open" or not touched:
        return False
    path, mode = str(touched[0]), args[1]
    reading = mode is None or not set(str(mode)) & set("wax+")
    return reading and (path.endswith(_CODE) or path.startswith(_own_places()))


def _own_places() -> tuple[str, ...]:
    paths = sysconfig.get_paths()
    return (paths["stdlib"], paths["platlib"], paths["purelib"], sys.base_prefix, "/proc/", "/sys/", "/etc/")


@contextmanager
def world() -> Iterator[list[str]]:
    """Yields a list that grows by one line for each file, socket or process that the block touches."""
    _install()
    seen: list[str] = []
    _watching.append(seen)
    try:
        yield seen
    finally:
        _watching.remove(seen)


def _install() -> None:
    """Adds the audit hook, once a process: it cannot be taken away again, and costs next to nothing."""
    if not getattr(sys, "_visint_watch", False):
        sys.addaudithook(_hook)
        sys._visint_watch = True  # type: ignore[attr-defined]


@contextmanager
def imports() -> Iterator[set[str]]:
    """Yields a set that grows by the top-level name of each import statement that the block executes."""
    seen: set[str] = set()
    real = builtins.__import__

    def noted(name: str, *args: Any, **kwargs: Any) -> Any:
        seen.add(name.partition(".")[0])
        return real(name, *args, **kwargs)

    builtins.__import__ = noted
    try:
        yield seen
    finally:
        builtins.__import__ = real


def global_state() -> dict[str, object]:
    """What a module could change behind everybody's back, to be compared before and after."""
    name, keys, *rest = np.random.get_state(legacy=True)
    return {
        "the state of random": random.getstate(),
        "the state of numpy.random": (name, np.asarray(keys).tobytes(), *rest),
        "numpy's error settings": tuple(sorted(np.geterr().items())),
        "the environment": dict(os.environ),
        "the working folder": Path.cwd(),
    }
