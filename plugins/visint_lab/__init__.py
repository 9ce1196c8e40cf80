"""The lab: scenes with exact truth, metrics, peers, the published tables, and the demonstration."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from visint.hookspecs import hookimpl

if TYPE_CHECKING:
    from visint.module import Module

visint_contract = 1


@hookimpl
def visint_modules() -> list[type[Module[Any, Any, Any]]]:
    """The lab's modules: rendered scenes as a node, the metrics, and the relay that engines are timed with."""
    from visint_lab.engines.relay import Relay
    from visint_lab.metrics import MODULES
    from visint_lab.render.node import Render

    return [Render, *MODULES, Relay]
