"""What ships with a package: texts and bytes inside it, folders beside it."""

from __future__ import annotations

import importlib.util
from importlib.resources import files
from pathlib import Path

__all__ = ["resource_bytes", "resource_text", "shipped_folder"]


def resource_bytes(package: str, *path: str) -> bytes:
    """A file inside an importable package: ``resource_bytes("visint.results", "report.css")``.

    Raises
    ------
    FileNotFoundError
        If the package does not bring it: a broken installation, not a wrong input.
    """
    return files(package).joinpath(*path).read_bytes()


def resource_text(package: str, *path: str) -> str:
    """As :func:`resource_bytes`, decoded from UTF-8."""
    return resource_bytes(package, *path).decode("utf-8")


def shipped_folder(package: str, checkout: str = "") -> Path | None:
    """The folder of a package of data files such as graphs, found without importing anything.

    Parameters
    ----------
    package
        Its dotted name, as an entry point of ``visint.graphs`` gives it: ``visint_graphs``,
        ``my_plugin.graphs``.
    checkout
        The folder of the same files in a source checkout, relative to its root; looked at if the package
        is not installed.

    Returns
    -------
    The folder, or None if there is none.
    """
    top, *rest = package.split(".")
    for place in _places(top):
        folder = place.joinpath(*rest)
        if folder.is_dir():
            return folder
    beside = Path(__file__).parents[2] / checkout
    return beside if checkout and beside.is_dir() else None


def _places(top: str) -> list[Path]:
    try:
        found = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        return []
    return [Path(place) for place in (found.submodule_search_locations or [])] if found else []
