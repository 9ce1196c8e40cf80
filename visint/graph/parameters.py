"""Parameters: a node's ``with`` made into its module's model, and what to say where that cannot be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from visint.graph.complaints import shown
from visint.graph.draft import Draft
from visint.graph.graph import Callee
from visint.module import Params
from visint.names import did_you_mean, listed

__all__ = ["make_params"]

Path = tuple[str | int, ...]


def make_params(
    draft: Draft, given: Mapping[str, Any], callee: Callee, path: Path
) -> Params | Mapping[str, Any]:
    """The parameters of a node from what stands at ``path``; problems are noted in the draft."""
    if callee.module is None:
        if given and callee.graph is not None:
            found, write = f"{callee.id} is a graph and takes no parameters", "(nothing: leave 'with' out)"
            draft.say("VI205", found, draft.where(*path, key=True), write=write)
        return given
    try:
        return callee.module.Params.model_validate(dict(given))
    except ValidationError as error:
        for item in error.errors(include_input=False, include_url=False):
            _complain(draft, item, given, callee, path)
        return callee.module.Params.model_construct()


def _complain(draft: Draft, item: Any, given: Mapping[str, Any], callee: Callee, path: Path) -> None:
    assert callee.module is not None
    known = callee.module.Params.model_fields
    param = str(item["loc"][0]) if item["loc"] else ""
    defaults = {
        name: None if info.is_required() else info.get_default(call_default_factory=True)
        for name, info in known.items()
    }
    choices = f"parameters of {callee.id}: " + listed(
        f"{name} = {shown(default)}" for name, default in defaults.items()
    )
    if item["type"] == "extra_forbidden" and param not in known:
        near = did_you_mean(param, known)
        write = f"{near}: {shown(given[param])}" if near else f"(nothing: leave {param!r} out)"
        found = f"{callee.id} has no parameter {param!r}"
        draft.say("VI205", found, draft.where(*path, param, key=True), choices, write)
        return
    said = str(item["msg"]).replace("Input should be", "should be").replace("Value error, ", "")
    if item["type"] == "missing":
        said, write = f"{callee.id} needs the parameter {param!r}", f"with: {{{param}: …}}"
    else:
        said = f"found {shown(given[param])}; {said}" if param in given else said
        write = f"{param}: {shown(defaults.get(param))}" if param else ""
    draft.say("VI205", said, draft.where(*path, *item["loc"]), choices, write)
