"""What pydantic says about a spec or about parameters, turned into problems a person can mend."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from visint.errors import Problem, Where
from visint.graph.spec import (
    FeedbackSpec,
    GraphSpec,
    HubSpec,
    LoopSpec,
    NodeSpec,
    SpokeSpec,
    StepSpec,
    UntilSpec,
)
from visint.names import did_you_mean

__all__ = ["complaints", "keys_of"]

Finder = Callable[..., Where]


def keys_of(model: type[BaseModel]) -> list[str]:
    """The keys a model takes, as written in a file."""
    return [str(info.validation_alias or name) for name, info in model.model_fields.items()]


def complaints(error: ValidationError, data: Any, where: Finder) -> list[Problem]:
    """One problem for each place that pydantic complains about, in the order of the file."""
    found: dict[tuple[Any, ...], Problem] = {}
    for item in error.errors(include_input=False, include_url=False):
        path = _path_in(data, item["loc"], item["type"])
        if path not in found:
            found[path] = _problem(item, path, where)
    return list(found.values())


def _path_in(data: Any, loc: tuple[int | str, ...], kind: str) -> tuple[int | str, ...]:
    """The part of pydantic's location that names places of the file: it adds the members of unions to it."""
    path: list[int | str] = []
    for step in loc:
        if _leads_on(data, step):
            path.append(step)
            data = data[step]
        elif kind == "missing" and step is loc[-1]:
            path.append(step)
    return tuple(path)


def _leads_on(data: Any, step: int | str) -> bool:
    if isinstance(data, list):
        return isinstance(step, int) and step < len(data)
    return isinstance(data, Mapping) and step in data


def _problem(item: Any, path: tuple[Any, ...], where: Finder) -> Problem:
    model = _model_at(path[:-1])
    if item["type"] == "extra_forbidden":
        known = keys_of(model)
        near = did_you_mean(str(path[-1]), known)
        return Problem(
            "VI105",
            f"there is no key {path[-1]!r} here",
            where(*path, key=True),
            "keys here: " + ", ".join(known),
            f"{near}:" if near else "",
        )
    if item["type"] == "missing":
        known = keys_of(model)
        lacks = where(*path[:-1])
        found, choices = f"the key {path[-1]!r} is missing", "keys here: " + ", ".join(known)
        return Problem("VI105", found, lacks, choices, f"{path[-1]}: …")
    return Problem("VI105", _sentence(item), where(*path))


def _sentence(item: Any) -> str:
    text = str(item["msg"]).replace("Input should be", "should be").replace("Value error, ", "")
    kinds = {
        "dict_type": "should be a mapping, {key: value}",
        "model_type": "should be a mapping, {key: value}",
    }
    kinds |= {"tuple_type": "should be a list, [a, b]", "string_type": "should be text"}
    return str(kinds.get(item["type"], text))


_CHILD: Mapping[type[BaseModel], Mapping[str, type[BaseModel]]] = {
    GraphSpec: {"loops": LoopSpec, "nodes": NodeSpec},
    HubSpec: {"spokes": SpokeSpec, "reconcile": StepSpec},
    NodeSpec: {"feedback": FeedbackSpec},
    SpokeSpec: {"feedback": FeedbackSpec},
}
_DIRECT: Mapping[tuple[type[BaseModel], str], type[BaseModel]] = {
    (GraphSpec, "hub"): HubSpec,
    (LoopSpec, "until"): UntilSpec,
    (SpokeSpec, "cohere"): StepSpec,
    (SpokeSpec, "reconcile"): StepSpec,
}


def _model_at(path: tuple[Any, ...]) -> type[BaseModel]:
    """The model that a path of keys leads to, GraphSpec at the root."""
    model: type[BaseModel] = GraphSpec
    steps = list(path)
    while steps:
        step = steps.pop(0)
        if (model, step) in _DIRECT:
            model = _DIRECT[model, step]
        elif step in _CHILD.get(model, {}) and steps:
            model = _CHILD[model][step]
            steps.pop(0)
    return model
