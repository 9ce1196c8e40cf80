"""What the shell offers after TAB: shipped graphs and files for a graph, ids for a module."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

__all__ = ["graphs", "modules"]


def graphs(incomplete: str) -> list[str]:
    """Names of installed graphs, graph files, run records, and folders on the way to them."""
    from visint.registry import installed

    names = [name for name in installed().graphs() if name.startswith(incomplete)]
    return names + sorted(_files(incomplete))


def _files(incomplete: str) -> Iterator[str]:
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    try:
        found = sorted(folder.iterdir())
    except OSError:
        return
    for path in found:
        text = f"./{path}" if incomplete.startswith("./") else str(path)
        if text.startswith(incomplete) and path.is_dir():
            yield f"{text}/"
        elif text.startswith(incomplete) and (path.suffix in (".yaml", ".yml") or path.name == "run.json"):
            yield text


def modules(incomplete: str) -> list[str]:
    """Plugins by name, and the modules of the one that is spelled out."""
    from visint.errors import PluginError
    from visint.registry import installed

    catalog = installed()
    plugin, dot, _ = incomplete.partition(".")
    if not dot:
        return [name for name in catalog.plugin_names if name.startswith(incomplete)]
    try:
        found = catalog.plugin(plugin).modules
    except PluginError:
        return []
    return [one for one in (f"{plugin}.{name}" for name in found) if one.startswith(incomplete)]
