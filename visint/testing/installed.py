"""A fake installed distribution: what a test needs to be a stranger."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

__all__ = ["installed", "write_distribution"]

Entries = Mapping[str, Mapping[str, str]]


@contextmanager
def installed(
    distribution: str,
    *,
    plugins: Mapping[str, str] | None = None,
    files: Mapping[str, str] | None = None,
    groups: Entries | None = None,
    version: str = "1.0",
) -> Iterator[Path]:
    """Within the block ``distribution`` is installed, as ``importlib.metadata`` and imports see it.

    Yields the folder that stands for its site-packages: put it on ``PYTHONPATH`` for a new process. What
    was imported from it is forgotten at the end.

    Parameters
    ----------
    plugins
        Entry points of ``visint.plugins``: name → ``"package"`` or ``"package:object"``.
    files
        Relative path → text, such as ``{"my_plugin/__init__.py": "..."}``.
    groups
        Entry points of other groups: group → name → target.

    Examples
    --------
    ::

        with installed("toys", plugins={"toy": "visint.testing.plugin"}):
            ...
    """
    with TemporaryDirectory(prefix=f"{distribution}-") as place:
        folder = Path(place)
        entries = {"visint.plugins": plugins or {}, **(groups or {})}
        write_distribution(folder, distribution, version, entries, files or {})
        sys.path.insert(0, place)
        importlib.invalidate_caches()
        try:
            yield folder
        finally:
            sys.path.remove(place)
            _forget(place)


def write_distribution(
    folder: Path, distribution: str, version: str, entries: Entries, files: Mapping[str, str]
) -> None:
    """Writes ``files`` and the metadata of ``distribution`` into ``folder``, as an installer would."""
    points = "\n".join(
        f"[{group}]\n" + "".join(f"{name} = {target}\n" for name, target in named.items())
        for group, named in entries.items()
        if named
    )
    about = f"{distribution.replace('-', '_')}-{version}.dist-info"
    metadata = f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n"
    everything = {**files, f"{about}/METADATA": metadata, f"{about}/entry_points.txt": points}
    for path, text in everything.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


def _forget(place: str) -> None:
    gone = [
        name
        for name, module in list(sys.modules.items())
        if str(getattr(module, "__file__", None) or "").startswith(place)
    ]
    for name in gone:
        del sys.modules[name]
    importlib.invalidate_caches()
