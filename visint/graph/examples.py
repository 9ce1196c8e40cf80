"""What a right value of each key looks like: the line that a message tells to write."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import BaseModel

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

__all__ = ["CHILDREN", "EXAMPLES", "MEMBERS"]

Model = type[BaseModel]

_NODE = {
    "uses": "plugin.module",
    "with": "{parameter: 1}",
    "levels": "[0, 1]",
    "at": "{0: {parameter: 1}}",
    "in": "{port: node.port}",
    "feedback": "{port: {from: node.port, start: none}}",
}

EXAMPLES: Mapping[Model, Mapping[str, str]] = {
    GraphSpec: {
        "visint": "1",
        "name": "my_graph",
        "about": '"What it is for."',
        "inputs": "{left: Image, right: Image}",
        "loops": "{sweeps: {times: 20}}",
        "nodes": "{match: {uses: plugin.module, in: {left: inputs.left}}}",
        "hub": "{order: [stereo], spokes: {stereo: {uses: plugin.module}}}",
        "controls": "{shading: {couple.alpha: 0}}",
        "outputs": "{depth: node.port}",
    },
    LoopSpec: {
        "over": "pyramid",
        "coarsest": "8",
        "levels": "7",
        "between": "{Disparity: replicate}",
        "inside": "levels",
        "times": "20",
        "until": "{change_of: node.port, below: 1.0e-3}",
        "on_exhausted": "accept",
    },
    UntilSpec: {"change_of": "node.port", "below": "1.0e-3", "patience": "2", "holds": "node.port"},
    FeedbackSpec: {"from": "node.port", "start": "none", "restart": "levels"},
    NodeSpec: {**_NODE, "loop": "sweeps", "of": "spoke"},
    StepSpec: {"uses": "plugin.module", "with": "{parameter: 1}", "in": "{port: node.port}"},
    SpokeSpec: {**_NODE, "cohere": "{uses: none}", "reconcile": "{uses: replace}"},
    HubSpec: {
        "uses": "plugin.policy",
        "loop": "sweeps",
        "start": "{depth: plane}",
        "order": "[stereo, shading]",
        "reconcile": "{depth: {uses: plugin.module}}",
        "spokes": "{stereo: {uses: plugin.module}}",
    },
}
"""A right value of each key of each part of a graph file."""

_PORTS = {"in": "node.port", "feedback": "{from: node.port, start: none}", "at": "{parameter: 1}"}

MEMBERS: Mapping[tuple[Model, str], str] = {
    (GraphSpec, "inputs"): "Image",
    (GraphSpec, "loops"): "{times: 20}",
    (GraphSpec, "nodes"): "{uses: plugin.module}",
    (GraphSpec, "controls"): "{node.parameter: 0}",
    (GraphSpec, "outputs"): "node.port",
    (LoopSpec, "between"): "linear",
    (HubSpec, "start"): "plane",
    (HubSpec, "reconcile"): "{uses: plugin.module}",
    (HubSpec, "spokes"): "{uses: plugin.module}",
    (StepSpec, "in"): "node.port",
    **{(NodeSpec, key): value for key, value in _PORTS.items()},
    **{(SpokeSpec, key): value for key, value in _PORTS.items()},
}
"""A right value of each member of those keys whose value is a mapping from names of one's own."""

CHILDREN: Mapping[tuple[Model, str], Model] = {
    (GraphSpec, "loops"): LoopSpec,
    (GraphSpec, "nodes"): NodeSpec,
    (GraphSpec, "hub"): HubSpec,
    (LoopSpec, "until"): UntilSpec,
    (HubSpec, "spokes"): SpokeSpec,
    (HubSpec, "reconcile"): StepSpec,
    (NodeSpec, "feedback"): FeedbackSpec,
    (SpokeSpec, "feedback"): FeedbackSpec,
    (SpokeSpec, "cohere"): StepSpec,
    (SpokeSpec, "reconcile"): StepSpec,
}
"""The model of what lies under a key, or under its members where it has a member in :data:`MEMBERS`."""
