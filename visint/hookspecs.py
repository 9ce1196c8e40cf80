"""The hooks: everything a plugin can give to visint, on one screen.

A plugin is an installed distribution with an entry point in the group ``visint.plugins``; the object it
names (a module, usually) implements any of these, each marked with :data:`hookimpl`. Hooks are asked when a
plugin is loaded, or once a run; never for a node.

A plugin may say for which version of the module contract it was written: ``visint_contract = 1``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import pluggy

if TYPE_CHECKING:
    from visint.events import Event
    from visint.fields.kinds import FieldKind
    from visint.module import Module

__all__ = ["hookimpl", "hookspec"]

hookspec = pluggy.HookspecMarker("visint")
hookimpl = pluggy.HookimplMarker("visint")
"""Marks a function of a plugin as the implementation of the hook of its name."""


@hookspec
def visint_modules() -> Iterable[type[Module[Any, Any, Any]]]:  # type: ignore[empty-body]
    """The vision modules of this plugin, as classes. Their ids are ``<entry point>.<class.name>``."""


@hookspec
def visint_fields() -> Iterable[FieldKind]:  # type: ignore[empty-body]
    """Field kinds of this plugin's own, named ``<entry point>.<Name>``."""


@hookspec
def visint_policies() -> Mapping[str, Mapping[str, Mapping[str, Any]]]:  # type: ignore[empty-body]
    """Hub policies: name → evidence kind → ``{"cohere": STEP, "reconcile": STEP}``.

    A step is written as in a graph file, ``{"uses": "bayes.depth", "with": {...}}``; the key ``"*"`` stands
    for every kind that is not named.
    """


@hookspec
def visint_writers() -> Mapping[str, Callable[[str, Any], Mapping[str, bytes]]]:  # type: ignore[empty-body]
    """Writers for field kinds: kind → function of (output name, value) that returns file name → bytes."""


@hookspec
def visint_observers() -> Iterable[Callable[[Event], None]]:  # type: ignore[empty-body]
    """Callables that receive every event of a run; asked once a run."""
