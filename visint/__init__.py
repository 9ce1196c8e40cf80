"""visint: recover 3-D structure from a stereo pair by integrating vision modules.

``import visint`` loads nothing heavy; each public name is imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from visint.engine.options import Options as Options
    from visint.engine.run import run as run
    from visint.errors import Cancelled as Cancelled
    from visint.errors import GraphError as GraphError
    from visint.errors import InputError as InputError
    from visint.errors import ModuleError as ModuleError
    from visint.errors import OutputError as OutputError
    from visint.errors import PluginError as PluginError
    from visint.errors import UsageError as UsageError
    from visint.errors import VisintError as VisintError
    from visint.fields.camera import Camera as Camera
    from visint.fields.evidence import Evidence as Evidence
    from visint.fields.kinds import FieldKind as FieldKind
    from visint.fields.light import Light as Light
    from visint.graph import Builder as Builder
    from visint.graph import Graph as Graph
    from visint.graph.alter import alter as alter
    from visint.graph.load import load as load
    from visint.hookspecs import hookimpl as hookimpl
    from visint.module import CONTRACT as CONTRACT
    from visint.module import Context as Context
    from visint.module import Module as Module
    from visint.module import Params as Params
    from visint.module import Ports as Ports
    from visint.results import Result as Result
    from visint.results.report.notebook import show as show

__version__ = "0.1.0"

_HOME = {
    "Builder": "graph",
    "CONTRACT": "module",
    "Camera": "fields.camera",
    "Cancelled": "errors",
    "Context": "module",
    "Evidence": "fields.evidence",
    "FieldKind": "fields.kinds",
    "Graph": "graph",
    "GraphError": "errors",
    "InputError": "errors",
    "Light": "fields.light",
    "Module": "module",
    "ModuleError": "errors",
    "Options": "engine",
    "OutputError": "errors",
    "Params": "module",
    "PluginError": "errors",
    "Ports": "module",
    "Result": "results",
    "UsageError": "errors",
    "VisintError": "errors",
    "hookimpl": "hookspecs",
    "alter": "graph",
    "load": "graph",
    "run": "engine",
    "show": "results.report.notebook",
}

__all__ = [*sorted(_HOME), "__version__"]  # noqa: PLE0604 - the table is the list


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'visint' has no attribute {name!r}")
    return getattr(importlib.import_module(f"visint.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
