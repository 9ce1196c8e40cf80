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
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        hide_input_in_errors=True,
        validate_by_name=True,
        use_attribute_docstrings=True,  # they are the descriptions in the JSON schema
    )


class UntilSpec(_Part):
    """When a loop has gone round enough: ``change_of`` a port stays ``below`` a bound, or a port ``holds``."""

    change_of: Ref | None = None
    """A port of numbers in the loop: its relative rms change from turn to turn is looked at."""
    below: float | None = Field(default=None, gt=0, strict=True)
    """The change under which the loop has converged."""
    patience: int = Field(default=1, ge=1, strict=True)
    """How many turns in a row the change must stay below."""
    holds: Ref | None = None
    """A flag in the loop: it ends when this is true."""


class LoopSpec(_Part):
    """A loop: a bounded number of turns, or a pyramid of levels from coarse to fine."""

    over: Literal["pyramid"] | None = None
    """`pyramid`: the body runs once a level, from coarse to fine."""
    coarsest: int | None = Field(default=None, ge=1, strict=True)
    """Pixels of the shorter side at the coarsest level, at least."""
    levels: int | None = Field(default=None, ge=1, le=16, strict=True)
    """How many levels, where `coarsest` does not say."""
    between: dict[str, Interpolation] = {}
    """How values of a kind are brought to the next finer level: replicate, linear or quadratic."""
    inside: str | None = None
    """The loop that this one lies in."""
    times: int | None = Field(default=None, ge=1, strict=True)
    """How many turns at most; a bound is mandatory."""
    until: UntilSpec | None = None
    """When to end before that."""
    on_exhausted: Literal["accept", "warn", "fail"] = "accept"
    """What a bound reached without an end means: accept, warn or fail."""


class FeedbackSpec(_Part):
    """A port fed by the turn before: ``from`` where, what to ``start`` with, and when to ``restart``."""

    from_: Ref = Field(validation_alias="from", serialization_alias="from")
    """The port whose value of the turn before is read."""
    start: Annotated[Start, BeforeValidator(_none)] = None
    """The value of the first turn: `none`, a number, `plane` or a reference from outside the loop."""
    restart: str | None = None
    """An outer loop at each of whose turns the value starts anew."""


class NodeSpec(_Part):
    """A node: the module it ``uses``, its parameters, its loop and where each port comes from."""

    uses: str
    """The module, `plugin.module`, or `graph:NAME` for a graph called as a node."""
    with_: dict[str, Any] = Field(default={}, validation_alias="with", serialization_alias="with")
    """Its parameters."""
    loop: str | None = None
    """The loop it runs in."""
    levels: tuple[int, ...] | None = None
    """The levels it runs at; elsewhere its outputs are absent."""
    at: dict[int, dict[str, Any]] = {}
    """Parameters at single levels: `{0: {iterations: 40}}`."""
    in_: dict[str, Ref | tuple[Ref, ...]] = Field(default={}, validation_alias="in", serialization_alias="in")
    """Where each port comes from: `node.port`, `inputs.name`, `map.field`, or a list of them."""
    feedback: dict[str, FeedbackSpec] = {}
    """Ports fed by the turn before."""
    of: str | None = None
    """The spoke that this node belongs to, where a hub was spelled out."""


class StepSpec(_Part):
    """What a hub does with evidence: the module, or the built-in ``none`` or ``replace``."""

    uses: str | None = None
    """The module of the step, or `none` or `replace`; the policy's own if not given."""
    with_: dict[str, Any] = Field(default={}, validation_alias="with", serialization_alias="with")
    """Its parameters, over those of the policy."""
    in_: dict[str, Ref | tuple[Ref, ...]] = Field(default={}, validation_alias="in", serialization_alias="in")
    """Where its ports come from, where their names do not say it."""


class SpokeSpec(_Part):
    """A spoke: a node that only estimates, and how its evidence is validated and enters the map."""

    uses: str
    """The module, `plugin.module`, whose evidence enters the map."""
    with_: dict[str, Any] = Field(default={}, validation_alias="with", serialization_alias="with")
    """Its parameters."""
    levels: tuple[int, ...] | None = None
    """The levels it runs at; elsewhere it leaves the map as it is."""
    at: dict[int, dict[str, Any]] = {}
    """Parameters at single levels: `{0: {iterations: 40}}`."""
    in_: dict[str, Ref | tuple[Ref, ...]] = Field(default={}, validation_alias="in", serialization_alias="in")
    """Where each port comes from, where its name does not say it: `node.port`, `inputs.name`, `map.field`."""
    feedback: dict[str, FeedbackSpec] = {}
    """Ports fed by the turn before."""
    cohere: StepSpec = StepSpec()
    """How its evidence is validated among neighbours, instead of the policy's way."""
    reconcile: StepSpec = StepSpec()
    """How the map moves towards its evidence, instead of the policy's way."""


class HubSpec(_Part):
    """A hub: the map's start, the spokes in order, and the policy for their evidence."""

    uses: str | None = None
    """The policy: which step of coherence and of mapping goes with each kind of evidence."""
    loop: str | None = None
    """The loop whose turns are the sweeps over all spokes."""
    start: dict[str, Annotated[Start, BeforeValidator(_none)]] = {}
    """What each field of the map starts with: `none`, a number, `plane` or a reference."""
    order: tuple[str, ...]
    """The spokes in the order of a sweep, each once."""
    reconcile: dict[str, StepSpec] = {}
    """Fields that are written once at the end of a sweep, from all their evidence together."""
    spokes: dict[str, SpokeSpec]
    """The cues around the map, by name."""


class GraphSpec(_Part):
    """A whole graph file."""

    visint: Literal[1]
    """The version of the format: 1."""
    name: str
    """The graph's name; in a shipped graph the stem of its file."""
    about: str = ""
    """What it does, in a sentence."""
    inputs: dict[str, str | tuple[str]] = {}
    """What it is given, by name: `Image`, optional `Light?`, a list `[Image]`."""
    loops: dict[str, LoopSpec] = {}
    """Its loops, by name."""
    nodes: dict[str, NodeSpec] = {}
    """Its nodes, by name."""
    hub: HubSpec | None = None
    """The intrinsic map with its spokes, for graphs that integrate cues."""
    controls: dict[str, dict[str, Any]] = {}
    """Settings `node.parameter` that take a cue's effect away, by name."""
    outputs: dict[str, Ref] = Field(min_length=1)
    """What it gives: `node.port` or `map.field`, by name."""

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
