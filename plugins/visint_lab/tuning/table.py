"""What is learned from: candidates' signs and their true errors, scene by scene."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import visint
from visint.arrays import Array
from visint_lab.datasets.pair import Pair
from visint_lab.metrics import depth_scores, filled_from_rows, shape_scores
from visint_lab.render.rendering import Rendering, render
from visint_lab.scenes import scene

__all__ = ["Sample", "gathered", "samples_in", "written"]


@dataclass(frozen=True, eq=False)
class Sample:
    """One scene: ``signs`` (K, F) of its candidates, ``ratios`` (K, 2) of their squared errors of depth and of
    normals to the stereo's.
    """

    scene: str
    seed: int
    size: int
    signs: Array
    ratios: Array


def gathered(scenes: Iterable[tuple[str, int]], size: int, lit: bool) -> Iterator[Sample]:
    """Runs ``joint_candidates`` on each scene; scenes without candidates are left out.

    Parameters
    ----------
    lit
        Whether the system is told the light.
    """
    graph = visint.load("joint_candidates")
    for name, seed in scenes:
        pair = render(scene(name, size, seed), seed=seed)
        given: dict[str, Any] = {"left": pair.left, "right": pair.right, "camera": pair.camera}
        result = visint.run(graph, {**given, "light": pair.light} if lit else given)
        surfaces = result["surfaces"]
        if surfaces.shape[-1]:
            signs = np.asarray(result["signs"]).reshape(surfaces.shape[-1], -1)
            yield Sample(name, seed, size, signs, _ratios(surfaces, result["disparity"], pair))


def _ratios(surfaces: Array, stereo: Array, pair: Rendering) -> Array:
    before = _errors(stereo, pair)
    found = [_errors(np.ascontiguousarray(surfaces[..., k]), pair) for k in range(surfaces.shape[-1])]
    return np.array(found) / before


def _errors(disparity: Array, pair: Rendering) -> Array:
    """Mean squared error of depth and of normals over the foreground."""
    inside = np.where(pair.truth.foreground, disparity, np.float32(np.nan))
    depth, normals = Pair.of(pair).geometry(filled_from_rows(inside))
    deep = depth_scores(depth, pair.truth.depth)["mse"]
    return np.array([deep, shape_scores(normals, pair.truth.normals)["s"]])


def written(samples: Iterable[Sample]) -> list[dict[str, Any]]:
    """As JSON holds it."""
    rows = []
    for one in samples:
        arrays = {"signs": np.round(one.signs, 5).tolist(), "ratios": np.round(one.ratios, 5).tolist()}
        rows.append({"scene": one.scene, "seed": one.seed, "size": one.size, **arrays})
    return rows


def samples_in(rows: Iterable[dict[str, Any]]) -> list[Sample]:
    """The reverse of :func:`written`."""
    return [
        Sample(row["scene"], row["seed"], row["size"], np.array(row["signs"], float), np.array(row["ratios"]))
        for row in rows
    ]
