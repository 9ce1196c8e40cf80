"""The lab: scenes with exact truth, metrics, peers, the published tables, and the demonstration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from visint.hookspecs import hookimpl

if TYPE_CHECKING:
    from visint.module import Module

visint_contract = 1


@hookimpl
def visint_modules() -> list[type[Module[Any, Any, Any]]]:
    """The lab's modules: the demonstration's scene as a node, and the metrics."""
    from visint_lab.metrics import MODULES

    return list(MODULES)
