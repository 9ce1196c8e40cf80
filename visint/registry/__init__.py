"""Finding plugins without importing them, loading one by name, and looking up what they bring."""

from visint.registry.catalog import Catalog, installed
from visint.registry.discover import GROUPS, Entry, discover
from visint.registry.load import Plugin, load_plugin

__all__ = ["GROUPS", "Catalog", "Entry", "Plugin", "discover", "installed", "load_plugin"]
