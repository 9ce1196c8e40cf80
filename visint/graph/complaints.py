"""What pydantic says about a spec, turned into problems a person can mend: found, wanted, the line to write."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from visint.errors import GraphError, Problem, Where
from visint.graph.examples import CHILDREN, EXAMPLES, MEMBERS
from visint.graph.spec import GraphSpec
from visint.graph.write import as_written
from visint.names import did_you_mean, listed

__all__ = ["complaints", "keys_of", "made", "shown"]

Finder = Callable[..., Where]
Path = tuple[int | str, ...]
Model = TypeVar("Model", bound=BaseModel)


def keys_of(model: type[BaseModel]) -> list[str]:
    """The keys a model takes, as written in a file."""
    return [str(info.validation_alias or name) for name, info in model.model_fields.items()]


def shown(value: Any) -> str:
    """A value of a graph file in a message: short, and on one line."""
    if isinstance(value, dict | list):
        return {dict: "a mapping", list: "a list"}[type(value)] if value else "nothing in it"
    if value is None or isinstance(value, bool):
        return {None: "nothing", True: "true", False: "false"}[value]
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"


def complaints(error: ValidationError, data: Any, where: Finder) -> list[Problem]:
    """One problem for each place that pydantic complains about, in the order of the file."""
    return _told(error.errors(include_input=False, include_url=False), data, where)


def _told(items: Sequence[Any], data: Any, where: Finder) -> list[Problem]:
    found: dict[Path, tuple[str, Problem]] = {}
    for item in items:
        path = _path_in(data, item["loc"], item["type"])
        if item["loc"][-1:] == ("str",) and isinstance(_at(data, path), list):
            continue  # text or a list may stand here; what is wrong with the list is told by itself
        if path not in found:
            found[path] = _problem(item, path, data, where)
    meant = {
        (*path[:-1], near)
        for path, (near, _) in found.items()
        if near  # a typo is told once, not as missing too
    }
    told = [problem for path, (near, problem) in found.items() if near or path not in meant]
    return sorted(told, key=lambda problem: (problem.where.line, problem.where.column))


def made(model: type[Model], data: Mapping[str, Any], file: str, *path: str) -> Model:
    """A part of a graph that is built in code, which would stand at ``path``; complaints are those of a file.

    Raises
    ------
    GraphError
        VI105, as for a graph file.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        whole: Any = data
        for key in reversed(path):
            whole = {key: whole}
        items = [{**item, "loc": (*path, *item["loc"])} for item in error.errors(include_url=False)]
        where = partial(_nowhere, file)
        raise GraphError(_told(items, whole, where)) from None


def _nowhere(file: str, *path: str | int, key: bool = False) -> Where:  # noqa: ARG001 - the form of a finder
    return Where(file, path=".".join(map(str, path)))


def _path_in(data: Any, loc: tuple[int | str, ...], kind: str) -> Path:
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


def _at(data: Any, path: Path) -> Any:
    for step in path:
        data = data[step] if _leads_on(data, step) else None
    return data


class _Spot(NamedTuple):
    """Where in the form of graph files a path leads: to a key of a model, or to a member of its value."""

    model: type[BaseModel]
    key: str
    member: str

    @property
    def example(self) -> str:
        """A line that would be right there."""
        if self.member and (self.model, self.key) in MEMBERS:
            return f"{self.member}: {MEMBERS[self.model, self.key]}"
        return f"{self.key}: {EXAMPLES[self.model].get(self.key, '…')}" if self.key else ""


def _spot(path: Path) -> _Spot:
    model: type[BaseModel] = GraphSpec
    key = member = ""
    for step in map(str, path):
        if (model, key) in CHILDREN and (member or (model, key) not in MEMBERS):
            model, key, member = CHILDREN[model, key], step, ""
        elif key:
            member = member or step
        else:
            key = step
    return _Spot(model, key, member)


def _problem(item: Any, path: Path, data: Any, where: Finder) -> tuple[str, Problem]:
    """The key that was meant, for an unknown key; and the problem."""
    spot, value = _spot(path), _at(data, path)
    if item["type"] == "extra_forbidden":
        return _unknown_key(spot, path, value, where)
    if item["type"] == "missing":
        choices = "keys here: " + listed(keys_of(spot.model))
        return "", Problem("VI105", f"the key {path[-1]!r} is missing", where(*path), choices, spot.example)
    if item["loc"][-1] == "[key]":
        found = f"the key {shown(path[-1])} {_wanted(item)}"
        write = f"{spot.key}: {EXAMPLES[spot.model].get(spot.key, '…')}"
        return "", Problem("VI105", found, where(*path, key=True), write=write)
    choices, write = _choice(item, spot, value)
    return "", Problem("VI105", f"found {shown(value)}; {_wanted(item)}", where(*path), choices, write)


def _unknown_key(spot: _Spot, path: Path, value: Any, where: Finder) -> tuple[str, Problem]:
    known = keys_of(spot.model)
    near = did_you_mean(spot.key, known) or ""
    write = f"{near}: {as_written(value)}" if near else "(nothing: leave the key out)"
    found, choices = f"there is no key {path[-1]!r} here", "keys here: " + listed(known)
    return near, Problem("VI105", found, where(*path, key=True), choices, write)


def _choice(item: Any, spot: _Spot, value: Any) -> tuple[str, str]:
    """The choices where there are a few words to choose from, and the line to write."""
    words = re.findall(r"'(\w+)'", str(item.get("ctx", {}).get("expected", "")))
    if words:
        near = did_you_mean(str(value), words) or words[0]
        return "choices: " + listed(words), f"{spot.member or spot.key}: {near}"
    if isinstance(value, str) and "." in value and item["type"] in ("model_type", "dict_type"):
        if spot.member and spot.key in ("nodes", "spokes", "reconcile"):
            return "", f"{spot.member}: {{uses: {as_written(value)}}}"
        if spot.key == "in" and not spot.member:
            return "", f"in: {{port: {as_written(value)}}}"
    if item["type"] == "too_long":
        return "", f"{spot.member or spot.key}: {as_written(value[:1])}"
    return "", spot.example


_WANTED = {
    "dict_type": "should be a mapping, {key: value}",
    "model_type": "should be a mapping, {key: value}",
    "model_attributes_type": "should be a mapping, {key: value}",
    "tuple_type": "should be a list, [a, b]",
    "string_type": "should be text",
    "int_type": "should be a whole number",
    "int_parsing": "should be a whole number",
    "int_from_float": "should be a whole number",
    "float_type": "should be a number",
    "float_parsing": "should be a number",
    "too_long": "should have one member",
    "too_short": "should have at least one member",
}


def _wanted(item: Any) -> str:
    text = str(item["msg"]).replace("Input should be", "should be").replace("Value error, ", "")
    return _WANTED.get(item["type"], text[:1].lower() + text[1:])
