"""Finding plugins without importing them, loading one by name, and looking up what they bring.

Finding loads nothing heavy, for ``visint --help`` needs it; the rest is imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from visint.registry.discover import GROUPS, Entry, discover

if TYPE_CHECKING:
    from visint.registry.catalog import Catalog, installed
    from visint.registry.load import Plugin, load_plugin

__all__ = ["GROUPS", "Catalog", "Entry", "Plugin", "discover", "installed", "load_plugin"]

_HOME = {"Catalog": "catalog", "installed": "catalog", "Plugin": "load", "load_plugin": "load"}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'visint.registry' has no attribute {name!r}")
    return getattr(importlib.import_module(f"visint.registry.{_HOME[name]}"), name)
