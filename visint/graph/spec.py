"""A graph file as data: frozen models that mirror the file key by key, and nothing more.

A spec knows no modules: that every name exists and every port fits is settled when it is bound.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from visint.fields.kinds import Interpolation

__all__ = [
    "VERSION",
    "FeedbackSpec",
    "GraphSpec",
    "HubSpec",
    "InputSpec",
    "LoopSpec",
    "NodeSpec",
    "SpokeSpec",
    "StepSpec",
    "UntilSpec",
]

VERSION = 1
"""The version of the graph-file format."""

Ref = str
"""``node.port``, ``inputs.name`` or ``map.field``."""
Start = float | str | None
"""Where a value that goes round begins: a number, ``plane``, ``none``, or a reference from outside the loop."""


def _none(value: Any) -> Any:
    return None if value == "none" else value


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True, validate_by_name=True)


class UntilSpec(_Part):
    """When a loop has gone round enough: ``change_of`` a port stays ``below`` a bound, or a port ``holds``."""

    change_of: Ref | None = None
    below: float | None = Field(default=None, gt=0, strict=True)
    patience: int = Field(default=1, ge=1, strict=True)
    holds: Ref | None = None


class LoopSpec(_Part):
    """A loop: a bounded number of turns, or a pyramid of levels from coarse to fine."""

    over: Literal["pyramid"] | None = None
    coarsest: int | None = Field(default=None, ge=1, strict=True)
    levels: int | None = Field(default=None, ge=1, le=16, strict=True)
    between: dict[str, Interpolation] = {}
    inside: str | None = None
    times: int | None = Field(default=None, ge=1, strict=True)
    until: UntilSpec | None = None
    on_exhausted: Literal["accept", "warn", "fail"] = "accept"


class FeedbackSpec(_Part):
    """A port fed by the turn before: ``from`` where, what to ``start`` with, and when to ``restart``."""

    from_: Ref = Field(validation_alias="from", serialization_alias="from")
    start: Annotated[Start, BeforeValidator(_none)] = None
    restart: str | None = None


class NodeSpec(_Part):
    """A node: the module it ``uses``, its parameters, its loop and where each port comes from."""

    uses: str
    with_: dict[str, Any] = Field(default={}, validation_alias="with", serialization_alias="with")
    loop: str | None = None
    levels: tuple[int, ...] | None = None
    at: dict[int, dict[str, Any]] = {}
    in_: dict[str, Ref | tuple[Ref, ...]] = Field(default={}, validation_alias="in", serialization_alias="in")
    feedback: dict[str, FeedbackSpec] = {}
    of: str | None = None


class StepSpec(_Part):
    """What a hub does with evidence: the module, or the built-in ``none`` or ``replace``."""

    uses: str | None = None
    with_: dict[str, Any] = Field(default={}, validation_alias="with", serialization_alias="with")
    in_: dict[str, Ref | tuple[Ref, ...]] = Field(default={}, validation_alias="in", serialization_alias="in")


class SpokeSpec(_Part):
    """A spoke: a node that only estimates, and how its evidence is validated and enters the map."""

    uses: str
    with_: dict[str, Any] = Field(default={}, validation_alias="with", serialization_alias="with")
    levels: tuple[int, ...] | None = None
    at: dict[int, dict[str, Any]] = {}
    in_: dict[str, Ref | tuple[Ref, ...]] = Field(default={}, validation_alias="in", serialization_alias="in")
    feedback: dict[str, FeedbackSpec] = {}
    cohere: StepSpec = StepSpec()
    reconcile: StepSpec = StepSpec()


class HubSpec(_Part):
    """A hub: the map's start, the spokes in order, and the policy for their evidence."""

    uses: str | None = None
    loop: str | None = None
    start: dict[str, Annotated[Start, BeforeValidator(_none)]] = {}
    order: tuple[str, ...]
    reconcile: dict[str, StepSpec] = {}
    spokes: dict[str, SpokeSpec]


class GraphSpec(_Part):
    """A whole graph file."""

    visint: Literal[1]
    name: str
    about: str = ""
    inputs: dict[str, str | tuple[str]] = {}
    loops: dict[str, LoopSpec] = {}
    nodes: dict[str, NodeSpec] = {}
    hub: HubSpec | None = None
    controls: dict[str, dict[str, Any]] = {}
    outputs: dict[str, Ref] = Field(min_length=1)

    def plain(self) -> Mapping[str, Any]:
        """The spec as the mapping a graph file holds: defaults left out, keys as written."""
        data: dict[str, Any] = self.model_dump(by_alias=True, exclude_defaults=True)
        _spell_starts(self, data)
        return {"visint": self.visint, **{key: _listed(value) for key, value in data.items()}}


def _listed(value: Any) -> Any:
    """Plain data has lists where a spec has tuples; keys stay what they are."""
    if isinstance(value, dict):
        return {key: _listed(one) for key, one in value.items()}
    return [_listed(one) for one in value] if isinstance(value, list | tuple) else value


def _spell_starts(spec: GraphSpec, data: dict[str, Any]) -> None:
    """A hub's ``none`` is spelled out: there, unlike on a feedback edge, leaving it out means another thing."""
    if spec.hub is not None and spec.hub.start:
        data["hub"]["start"] = {
            field: "none" if start is None else start for field, start in spec.hub.start.items()
        }


class InputSpec(NamedTuple):
    """An input of a graph as declared: ``Image``, optional ``Light?``, list ``[Image]``."""

    kind: str
    optional: bool
    many: bool

    @classmethod
    def parse(cls, text: str | tuple[str]) -> InputSpec:
        """The declaration spelled by ``text``."""
        if isinstance(text, tuple):
            return cls(text[0], False, True)
        return cls(text.removesuffix("?"), text.endswith("?"), False)

    def __str__(self) -> str:
        return f"[{self.kind}]" if self.many else self.kind + "?" * self.optional
