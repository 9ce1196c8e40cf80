"""Systems: visint's own graphs, run through the façade."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any

import visint
from visint.errors import GraphError
from visint.fields.geometry import disparity_from_depth
from visint_lab.datasets.pair import Pair
from visint_lab.peers import Cost
from visint_lab.trials.reconstruction import Reconstruction

__all__ = ["SystemVariant", "baseline_of", "controls_of", "cues_of", "installed", "reconstruct"]

_BASELINES = {"non_uniform": "stereo", "uniform_bayesian": "stereo", "joint": "stereo"}
_FALLBACK = "stereo_sgm"


@dataclass(frozen=True)
class SystemVariant:
    """A graph as it is, with other parameters, under one of its controls, or without one of its cues."""

    graph: str
    control: str | None = None
    without: tuple[str, ...] = ()
    settings: tuple[tuple[str, float], ...] = ()

    def __str__(self) -> str:
        parts = [f"control {self.control}"] if self.control else []
        parts += [f"{name} = {value:g}" for name, value in self.settings]
        parts += [f"without {cue}" for cue in self.without]
        return ", ".join([self.graph, *parts])

    def load(self) -> visint.Graph:
        """The graph so altered.

        Raises
        ------
        GraphError
            If there is no such graph, control or cue.
        """
        graph = visint.load(self.graph)
        if self.control is None and not self.without and not self.settings:
            return graph
        facade: Any = visint
        altered: visint.Graph = facade.alter(
            graph, settings=dict(self.settings), control=self.control, without=self.without
        )
        return altered


def installed(name: str) -> bool:
    """Whether there is a graph of that name (or path) that binds."""
    try:
        visint.load(name)
    except GraphError as error:
        if any(problem.code == "VI108" for problem in error.problems):
            return False
        raise
    return True


def baseline_of(system: str) -> str:
    """The stereo alone that a system is held against: its own matcher where that is a graph here."""
    own = _BASELINES.get(system, _FALLBACK)
    return own if installed(own) else _FALLBACK


def controls_of(system: str) -> tuple[SystemVariant, ...]:
    """The system under each of the controls its file names: a cue's amplitude at zero, all else kept."""
    return tuple(SystemVariant(system, control=name) for name in visint.load(system).spec.controls)


def cues_of(system: str) -> tuple[SystemVariant, ...]:
    """The system without each of its spokes; empty for a graph without a hub."""
    hub = visint.load(system).spec.hub
    return tuple(SystemVariant(system, without=(cue,)) for cue in (hub.order if hub else ()))


def reconstruct(
    variant: SystemVariant | str, pair: Pair, light: visint.Light | None = None, *, attribution: bool = False
) -> Reconstruction:
    """``variant`` on ``pair``, in this process. Peak memory is not known here and 0.

    With ``attribution`` it follows which cue decided what, which takes some milliseconds a commit.

    Raises
    ------
    VisintError
        Whatever loading and running raise.
    """
    variant = SystemVariant(variant) if isinstance(variant, str) else variant
    graph = variant.load()
    offered = {"left": pair.left, "right": pair.right, "camera": pair.camera, "light": light}
    inputs = {name: value for name, value in offered.items() if name in graph.inputs and value is not None}
    cpu, wall = process_time(), perf_counter()
    result = visint.run(graph, inputs, options=visint.Options(attribution=attribution))
    cost = Cost(process_time() - cpu, perf_counter() - wall, 0.0)
    return _gathered(str(variant), result, pair, cost)


def _gathered(name: str, result: visint.Result, pair: Pair, cost: Cost) -> Reconstruction:
    if "disparity" in result:
        disparity = result["disparity"]
    else:
        disparity = disparity_from_depth(result["depth"], pair.camera)
    maps: dict[str, Any] = {"normals": result.get("normals"), "seconds": _seconds(result)}
    field = "depth" if "depth" in result.confidence else "disparity"
    maps["confidence"] = result.confidence.get(field)
    depth = result.attribution.get("depth", {})
    maps["shares"] = {cue: float(share.mean(dtype=float)) for cue, share in depth.items()}
    return Reconstruction.of(name, disparity, pair, cost, **maps)


def _seconds(result: visint.Result) -> Mapping[str, float]:
    """By node, levels together."""
    total: dict[str, float] = {}
    for timing in result.record.timings():
        total[timing.node] = total.get(timing.node, 0.0) + timing.seconds
    return total
