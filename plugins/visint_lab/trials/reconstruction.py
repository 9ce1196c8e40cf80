"""What a system makes of a pair, whole enough to be compared: no holes, and what it cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from visint.arrays import Array
from visint.fields.geometry import disparity_from_depth
from visint_lab.datasets.pair import Pair
from visint_lab.metrics import (
    confidence_scores,
    depth_scores,
    disparity_scores,
    filled_from_rows,
    shape_scores,
)
from visint_lab.peers import Cost

__all__ = ["Reconstruction", "constant_plane", "scored"]


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """Maps of one pair, all (H, W[, 3]), float32.

    Parameters
    ----------
    disparity
        Filled: holes take the smaller of the nearest known values in their row.
    density
        Share of pixels that were known before.
    confidence
        Of the depth, 0 in former holes; None if the system has none.
    seconds
        By node, of the run; empty if not known.
    shares
        Mean share in [0, 1] of the depth that a cue decided, by cue; empty if not followed.
    """

    system: str
    disparity: Array
    depth: Array
    normals: Array
    density: float
    cost: Cost
    confidence: Array | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)
    shares: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, system: str, disparity: Array, pair: Pair, cost: Cost, **maps: Any) -> Reconstruction:
        """From a disparity map that may have holes; ``normals`` among ``maps`` are kept where known.

        In a rendered pair, holes of the object are not filled from what a matcher makes of the void around it.
        """
        inside = np.ones(disparity.shape, bool) if pair.depth is None else np.isfinite(pair.depth)
        filled = filled_from_rows(np.where(inside, disparity, np.float32(np.nan)))
        depth, normals = pair.geometry(filled)
        given = maps.pop("normals", None)
        if given is not None:
            normals = np.where(np.isfinite(given).all(axis=-1, keepdims=True), given, normals)
        density = float(np.isfinite(disparity[inside]).mean())
        return cls(system, filled, depth, normals, density, cost, **maps)


def constant_plane(pair: Pair) -> Reconstruction:
    """The floor: one plane at the median true depth. Stock matchers often fail to beat it."""
    depth = pair.depth if pair.depth is not None else pair.geometry(_true(pair))[0]
    plane = np.full(pair.left.shape, np.nanmedian(depth), dtype=np.float32)
    disparity = disparity_from_depth(plane, pair.camera)
    return Reconstruction.of("constant plane", disparity, pair, Cost(0.0, 0.0, 0.0))


def _true(pair: Pair) -> Array:
    if pair.disparity is None:
        raise ValueError(f"{pair.name} has no truth")
    return pair.disparity


def scored(found: Reconstruction, pair: Pair) -> Mapping[str, float]:
    """Every number that the pair's truth allows.

    Over all known truth (on rendered sets: the foreground) ``mse``, ``rmse``, ``median``, ``s``, ``angle``,
    ``bad1``, ``bad2``, ``mae``, ``ause``, ``risk90``; with ``_visible`` behind over pixels both cameras see;
    ``bad2_low`` over pixels of low texture.
    """
    truth = _true(pair)
    scores = dict(disparity_scores(found.disparity, truth))
    scores["density"] = found.density
    scores["bad2_low"] = disparity_scores(found.disparity, truth, pair.low_texture)["bad2"]
    if pair.visible is not None:
        visible = disparity_scores(found.disparity, truth, pair.visible)
        scores |= {"bad2_visible": visible["bad2"], "mae_visible": visible["mae"]}
    if pair.depth is not None and pair.normals is not None:
        scores |= _exact_scores(found, pair.depth, pair.normals, pair.visible)
    if found.confidence is not None:
        wrong = np.abs(found.disparity - truth)
        scores |= confidence_scores(wrong, found.confidence)
    return scores


def _exact_scores(
    found: Reconstruction, depth: Array, normals: Array, visible: Array | None
) -> Mapping[str, float]:
    scores: dict[str, float] = {}
    for suffix, mask in (("", None), ("_visible", visible)):
        deep, shape = depth_scores(found.depth, depth, mask), shape_scores(found.normals, normals, mask)
        part = {key: deep[key] for key in ("mse", "rmse", "median")}
        part |= {"s": shape["s"], "angle": shape["mean_angle"]}
        scores |= {key + suffix: value for key, value in part.items()}
    return scores
