"""Loading one plugin: imported by name, registered with pluggy, its failure its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from inspect import isabstract
from typing import Any

import pluggy

from visint import hookspecs
from visint.errors import PluginError
from visint.events import Observer
from visint.fields.assumptions import check_names
from visint.fields.kinds import FieldKind
from visint.module import CONTRACT, Module
from visint.names import is_name
from visint.registry.discover import Entry

__all__ = ["AnyModule", "Plugin", "Writer", "import_entry", "load_plugin"]

AnyModule = Module[Any, Any, Any]
Writer = Callable[[str, Any], Mapping[str, bytes]]


@dataclass(frozen=True, slots=True)
class Plugin:
    """A loaded plugin: its entry-point name, the distribution it came from, and what it gave."""

    name: str
    origin: str
    modules: Mapping[str, type[AnyModule]]
    fields: Mapping[str, FieldKind]
    policies: Mapping[str, Mapping[str, Mapping[str, Any]]]
    writers: Mapping[str, Writer]
    hooks: pluggy.HookRelay

    def observers(self) -> list[Observer]:
        """What the plugin wants to hear events with; asked once a run."""
        return [observer for given in self.hooks.visint_observers() for observer in given]


def import_entry(entry: Entry) -> Any:
    """The object an entry point names.

    Raises
    ------
    PluginError
        VI501, whatever the import did: raise, or try to exit.
    """
    try:
        return entry.target.load()
    except (Exception, SystemExit) as reason:
        raise _broken(entry.name, entry.origin, f"cannot be imported: {_short(reason)}") from reason


def load_plugin(name: str, origin: str, target: object) -> Plugin:
    """Registers ``target`` (a module, usually) as plugin ``name`` and asks its hooks.

    Raises
    ------
    PluginError
        VI501 if a hook is misspelled, raises or gives something that is not what it should be; VI503 if
        the plugin was written for another version of the contract.
    """
    wanted = getattr(target, "visint_contract", CONTRACT)
    if wanted != CONTRACT:
        raise PluginError.of(
            "VI503",
            f"plugin {name!r} ({origin}) was written for contract {wanted}; this visint has {CONTRACT}",
            write="pip install --upgrade " + (origin.split(" ", maxsplit=1)[0] if origin else name),
        )
    manager = pluggy.PluginManager("visint")
    manager.add_hookspecs(hookspecs)
    try:
        manager.register(target, name)
        manager.check_pending()
        _refuse_unknown_hooks(target)
        hook = manager.hook
        return Plugin(
            name,
            origin,
            _by_name(each for given in _given(hook.visint_modules) for each in given),
            _kinds(name, (kind for given in _given(hook.visint_fields) for kind in given)),
            dict(_policy(item) for given in _given(hook.visint_policies) for item in given.items()),
            {kind: writer for given in _given(hook.visint_writers) for kind, writer in given.items()},
            hook,
        )
    except (Exception, SystemExit) as reason:
        raise _broken(name, origin, _short(reason)) from reason


def _refuse_unknown_hooks(target: object) -> None:
    """Pluggy only knows marked functions; a misspelled, unmarked ``visint_module`` would be lost silently."""
    hooks = {name for name in vars(hookspecs) if name.startswith("visint_")} | {"visint_contract"}
    for name in dir(target):
        if name.startswith("visint_") and name not in hooks:
            raise ValueError(f"{name!r} is no hook; the hooks are {', '.join(sorted(hooks))}")
        if (
            name in hooks
            and callable(getattr(target, name))
            and not hasattr(getattr(target, name), "visint_impl")
        ):
            raise ValueError(f"{name!r} is not marked with @hookimpl")


def _given(hook: pluggy.HookCaller) -> list[Any]:
    """What a hook gave; pluggy drops None, so that a forgotten ``return`` would be lost silently."""
    given: list[Any] = hook()
    if hook.get_hookimpls() and not given:
        raise ValueError(f"{hook.name} gave nothing; does it return?")
    return given


def _by_name(modules: Iterable[Any]) -> dict[str, type[AnyModule]]:
    found: dict[str, type[AnyModule]] = {}
    for module in modules:
        if not (isinstance(module, type) and issubclass(module, Module)):
            raise TypeError(f"visint_modules gave {module!r}, which is no subclass of Module")
        if not is_name(module.name) or module.name in found:
            raise ValueError(f"module name {module.name!r} of {module.__qualname__} is taken or no name")
        if not hasattr(module, "Inputs"):
            raise TypeError(f"{module.__qualname__} does not say Module[Params, Inputs, Outputs]")
        check_names(module.assumptions)
        if isabstract(module):
            raise TypeError(f"{module.__qualname__} has no run")
        found[module.name] = module
    return dict(sorted(found.items()))


def _policy(item: tuple[str, Any]) -> tuple[str, Mapping[str, Mapping[str, Any]]]:
    """A policy, if it has the form kind → "cohere" or "reconcile" → step."""
    name, kinds = item
    steps = [(what, step) for each in kinds.values() for what, step in each.items()]
    for what, step in steps:
        if what not in ("cohere", "reconcile") or not {*step} <= {"uses", "with", "in"}:
            raise ValueError(
                f"policy {name!r}: a step is 'cohere' or 'reconcile' with uses, with, in; not {what!r}"
            )
    return name, kinds


def _kinds(plugin: str, kinds: Iterable[Any]) -> dict[str, FieldKind]:
    return {kind.name: kind for kind in (_own_kind(plugin, each) for each in kinds)}


def _own_kind(plugin: str, kind: Any) -> FieldKind:
    if not isinstance(kind, FieldKind):
        raise TypeError(f"visint_fields gave {kind!r}, which is no FieldKind")
    if not kind.name.startswith(f"{plugin}."):
        raise ValueError(f"field kind {kind.name!r} must be named '{plugin}.{kind.name.split('.')[-1]}'")
    return kind


def _short(reason: BaseException) -> str:
    text = str(reason).strip().splitlines()
    return f"{type(reason).__name__}: {text[0]}" if text else type(reason).__name__


def _broken(name: str, origin: str, reason: str) -> PluginError:
    found = f"plugin {name!r} ({origin}) {reason}"
    return PluginError.of("VI501", found, write="visint modules  (tells the state of every plugin)")
