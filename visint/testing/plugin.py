"""The toy modules as a plugin, shaped like a stranger's: install it under the entry point ``toy``.

Nothing installs it by itself. In a test::

    with installed("toys", plugins={"toy": "visint.testing.plugin"}):
        visint.run(visint.load("graph_of_toys.yaml"))
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from visint.hookspecs import hookimpl

if TYPE_CHECKING:
    from visint.module import Module

visint_contract = 1


@hookimpl
def visint_modules() -> Iterable[type[Module[Any, Any, Any]]]:
    """Every toy module."""
    from visint.testing.toys import TOYS

    return TOYS


@hookimpl
def visint_policies() -> Mapping[str, Mapping[str, Mapping[str, Any]]]:
    """The policy ``toy.even``: all evidence counts alike."""
    return {
        "even": {
            "Depth": {"cohere": {"uses": "toy.cohere"}, "reconcile": {"uses": "toy.blend"}},
            "Disparity": {"cohere": {"uses": "none"}, "reconcile": {"uses": "toy.blend_disparity"}},
            "*": {"cohere": {"uses": "none"}, "reconcile": {"uses": "replace"}},
        }
    }
