"""The catalog: modules, field kinds, policies, writers and graph files by name, loaded when asked for."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from copy import copy
from functools import lru_cache
from pathlib import Path
from typing import Any

from visint.errors import PluginError
from visint.fields.kinds import KINDS, FieldKind
from visint.names import ModuleId
from visint.registry.discover import Entry, discover, only
from visint.registry.load import AnyModule, Plugin, Writer, import_entry, load_plugin

__all__ = ["Catalog", "installed"]


class Catalog:
    """What can be named in a graph file.

    Plugins are loaded one by one, when something of theirs is first asked for. A broken one raises
    :class:`visint.PluginError` each time it is asked, and never stands in the way of another.

    Parameters
    ----------
    plugins
        Plugin name → object with hooks, taken instead of what is installed. For tests and notebooks; the
        objects go through the same door as installed ones.
    graphs
        Graph name → file, taken instead of the installed folders of graph files.
    """

    def __init__(
        self, plugins: Mapping[str, object] | None = None, graphs: Mapping[str, Path] | None = None
    ) -> None:
        self._given = plugins
        self._graphs = graphs
        self._claims: Mapping[str, Mapping[str, Path]] | None = None
        self._entries: Mapping[str, tuple[Entry, ...]] | None = None
        self._loaded: dict[str, Plugin | PluginError] = {}
        self.recorded: Mapping[str, Any] = {}
        """Graphs by name as a run record holds them, taken before files of the name; plain data."""

    def with_recorded(self, graphs: Mapping[str, Any]) -> Catalog:
        """The same catalog, but for ``graphs``, which are taken from a run record."""
        other = copy(self)
        other.recorded = graphs
        return other

    @property
    def plugin_names(self) -> tuple[str, ...]:
        """Names of all plugins, loaded or not; nothing is imported."""
        return tuple(sorted(self._given if self._given is not None else self._discovered()))

    def _discovered(self) -> Mapping[str, tuple[Entry, ...]]:
        if self._entries is None:
            self._entries = discover("visint.plugins")
        return self._entries

    def plugin(self, name: str) -> Plugin:
        """Plugin ``name``, loaded on first use.

        Raises
        ------
        PluginError
            VI504 if there is none, VI502 if two distributions claim the name, VI501 or VI503 if it is broken.
        """
        if name not in self._loaded:
            try:
                self._loaded[name] = self._load(name)
            except PluginError as error:
                self._loaded[name] = error
        plugin = self._loaded[name]
        if isinstance(plugin, PluginError):
            raise plugin
        return plugin

    def _load(self, name: str) -> Plugin:
        if name not in self.plugin_names:
            choices = "installed plugins: " + (", ".join(self.plugin_names) or "none")
            raise PluginError.of("VI504", f"no plugin is named {name!r}", choices=choices)
        if self._given is not None:
            return load_plugin(name, "given in code", self._given[name])
        entry = only(self._discovered()[name])
        return load_plugin(name, entry.origin, import_entry(entry))

    @property
    def loaded(self) -> Iterator[Plugin]:
        """The plugins that were asked for and are sound."""
        return (plugin for plugin in self._loaded.values() if isinstance(plugin, Plugin))

    def module(self, module: ModuleId) -> type[AnyModule] | None:
        """The module of that id, or None if its plugin has none of the name; raises as :meth:`plugin`."""
        return self.plugin(module.plugin).modules.get(module.name)

    def kind(self, name: str) -> FieldKind | None:
        """The field kind of that name, or None. ``plugin.Kind`` loads the plugin."""
        plugin, dot, _ = name.partition(".")
        if not dot or plugin not in self.plugin_names:
            return KINDS.get(name)
        return self.plugin(plugin).fields.get(name)

    def policy(self, name: str) -> Mapping[str, Mapping[str, Any]] | None:
        """The hub policy ``plugin.name``, or None if the plugin has none of the name."""
        plugin, _, policy = name.partition(".")
        return self.plugin(plugin).policies.get(policy)

    def writers(self) -> Mapping[str, Writer]:
        """Writers of the loaded plugins by field kind."""
        return {kind: writer for plugin in self.loaded for kind, writer in plugin.writers.items()}

    def graphs(self) -> Mapping[str, Path]:
        """Graph files by name (a file's stem), of every installed folder of graph files."""
        found = {name: next(iter(claims.values())) for name, claims in self._graph_claims().items()}
        return found | {name: Path(name) for name in self.recorded}

    def graph_file(self, name: str) -> Path | None:
        """The file of the graph ``name``, or None if there is none.

        Raises
        ------
        PluginError
            VI502 if two distributions bring a graph of that name; both are named, neither is chosen.
        """
        claims = self._graph_claims().get(name, {})
        if len(claims) > 1:
            found = f"the graph {name!r} is brought by {' and '.join(claims)}"
            files = "files: " + ", ".join(map(str, claims.values()))
            raise PluginError.of("VI502", found, choices=files, write=str(next(iter(claims.values()))))
        return next(iter(claims.values()), None)

    def _graph_claims(self) -> Mapping[str, Mapping[str, Path]]:
        if self._claims is None:
            given = self._graphs
            self._claims = _graph_files() if given is None else {name: {"code": given[name]} for name in given}
        return self._claims


def _graph_files() -> dict[str, dict[str, Path]]:
    """Graph files by name and by who brings them; of one distribution the first folder counts."""
    found: dict[str, dict[str, Path]] = {}
    for entry in (entry for entries in discover("visint.graphs").values() for entry in entries):
        for folder in _folders(entry):
            for path in sorted(folder.glob("*.yaml")):
                found.setdefault(path.stem, {}).setdefault(entry.origin, path)
    return dict(sorted(found.items()))


def _folders(entry: Entry) -> Iterator[Path]:
    """Where an entry point's folder may lie: in the checkout that runs, else beside the installed package."""
    parts = entry.target.value.split(".")
    checkout = Path(__file__).parents[2]
    if entry.distribution == "visint" and (checkout / "pyproject.toml").is_file():
        yield checkout / "graphs"
    yield from (Path(place, *parts) for place in sys.path if place and Path(place, *parts).is_dir())


@lru_cache(maxsize=4)
def _installed(path: tuple[str, ...]) -> Catalog:  # noqa: ARG001 - another path, another catalog
    return Catalog()


def installed() -> Catalog:
    """The catalog of everything installed, the same object as long as ``sys.path`` is the same."""
    return _installed(tuple(sys.path))
