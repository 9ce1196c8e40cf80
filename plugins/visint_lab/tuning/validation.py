"""How a system does against the same stereo alone on scenes it was not tuned on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import Any

import numpy as np

import visint
from visint.arrays import Array
from visint.fields.geometry import disparity_from_depth
from visint_lab.datasets.pair import Pair
from visint_lab.metrics import depth_scores, shape_scores
from visint_lab.peers import Cost
from visint_lab.render.rendering import Rendering, render
from visint_lab.scenes import scene
from visint_lab.trials.reconstruction import Reconstruction
from visint_lab.trials.systems import SystemVariant

__all__ = ["Verdict", "table", "verdicts"]

KINDS = ("lambertian", "specular", "checker")


@dataclass(frozen=True)
class Verdict:
    """One system on one scene: reductions, %, of squared errors over the stereo alone: of depth, normals, and
    of depth where the right view sees nothing. ``covered``: parts of errors within one stated sigma.
    """

    scene: str
    system: str
    depth: float
    shape: float
    hidden: float
    rmse: float
    s: float
    covered: tuple[float, float] = field(default=(float("nan"), float("nan")))


def verdicts(
    scenes: Iterable[tuple[str, int | None]], size: int, systems: Sequence[SystemVariant], baseline: str
) -> Iterator[Verdict]:
    """Scene after scene, the baseline first."""
    graphs = {str(system): system.load() for system in (SystemVariant(baseline), *systems)}
    for name, seed in scenes:
        rendering = render(scene(name, size, seed), seed=seed or 0)
        title = name if seed is None else f"{name}#{seed}"
        errors: dict[str, Array] = {}
        for system, graph in graphs.items():
            given = {key: getattr(rendering, key) for key in ("left", "right", "camera", "light")}
            result = visint.run(graph, {key: value for key, value in given.items() if key in graph.inputs})
            errors[system] = _errors(_whole(system, result, rendering), rendering)
            yield _verdict((title, system), errors[system], errors[baseline], _covered(result, rendering))


def _whole(system: str, result: visint.Result, rendering: Rendering) -> Reconstruction:
    """Without holes, as every comparison of the lab has it."""
    pair = Pair.of(rendering)
    disparity = result.get("disparity")
    if disparity is None:
        disparity = disparity_from_depth(result["depth"], rendering.camera)
    return Reconstruction.of(system, disparity, pair, Cost(0.0, 0.0, 0.0), normals=result.get("normals"))


def _verdict(names: tuple[str, str], own: Array, stereo: Array, covered: tuple[float, float]) -> Verdict:
    depth, shape, hidden = (100 * (1 - own / stereo)).tolist()
    return Verdict(*names, depth, shape, hidden, float(own[0] ** 0.5), float(own[1]), covered)


def _errors(found: Reconstruction, rendering: Rendering) -> Array:
    truth = rendering.truth
    hidden = truth.foreground & ~truth.visible
    deep, behind = (depth_scores(found.depth, truth.depth, mask)["mse"] for mask in (None, hidden))
    return np.array([deep, shape_scores(found.normals, truth.normals)["s"], behind])


def _covered(result: visint.Result, rendering: Rendering) -> tuple[float, float]:
    """Parts of the errors of depth and of normals within one stated sigma; NaN without such outputs."""
    if "depth_sigma" not in result or "normals_sigma" not in result:
        return float("nan"), float("nan")
    truth = rendering.truth
    far = np.abs(result["depth"] - truth.depth) <= result["depth_sigma"]
    turned = 2 * np.arcsin(np.clip(np.linalg.norm(result["normals"] - truth.normals, axis=-1) / 2, 0, 1))
    counted = np.isfinite(result["depth_sigma"]) & truth.foreground
    return float(far[counted].mean()), float((turned <= result["normals_sigma"])[counted].mean())


def table(found: Sequence[Verdict]) -> list[list[Any]]:
    """A row for each system and kind of surface: scenes, medians of D, S and hidden D, scenes made worse in D
    and in S by more than 2 %, the worst D, medians of what sigma covers.
    """
    rows: list[list[Any]] = []
    for system in dict.fromkeys(one.system for one in found):
        mine = [one for one in found if one.system == system]
        groups = {kind: [one for one in mine if kind in one.scene] for kind in KINDS}
        groups["other"] = [one for one in mine if not any(kind in one.scene for kind in KINDS)]
        rows += [_row(system, kind, group) for kind, group in {**groups, "all": mine}.items() if group]
    return rows


def _row(system: str, kind: str, group: Sequence[Verdict]) -> list[Any]:
    def middle(values: Iterable[float]) -> float:
        known = [value for value in values if np.isfinite(value)]
        return median(known) if known else float("nan")

    worse = [sum(getattr(one, key) < -2 for one in group) for key in ("depth", "shape")]
    gains = [middle(getattr(one, key) for one in group) for key in ("depth", "shape", "hidden")]
    covered = [100 * middle(one.covered[which] for one in group) for which in (0, 1)]
    return [system, kind, len(group), *gains, *worse, min(one.depth for one in group), *covered]
