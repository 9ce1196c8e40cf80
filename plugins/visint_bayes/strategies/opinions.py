"""Opinions: all evidence on depth brought to one form, a disparity and its precision from each cue."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from visint.arrays import Array, Boundaries, Confidence, Depth
from visint.fields import (
    Camera,
    DepthEvidence,
    DisparityEvidence,
    Evidence,
    NormalsEvidence,
    ReliefEvidence,
    SlopesEvidence,
    barriers,
)
from visint.fields.geometry import depth_from_disparity, slopes_from_normals
from visint.module import Ports
from visint_bayes.sureness import confidence_of, depth_per_pixel, disparity_of

__all__ = ["Opinions", "StrategyInputs", "StrategyOutputs", "answered", "gathered"]

SHARPEST = 0.1
"""No σ counts for less, px: matches have errors that no model of noise knows."""


class StrategyInputs(Ports):
    """All evidence on depth in a sweep, in any of five forms, and the map; without a camera 53° of view.

    A cue that knows depth or disparity says it itself. One that knows shape (normals, slopes, relief) says at
    which depth a pixel would bend as it wants, its neighbours in the map being where they are.
    """

    depth_evidence: tuple[DepthEvidence, ...] = ()
    disparity_evidence: tuple[DisparityEvidence, ...] = ()
    normals_evidence: tuple[NormalsEvidence, ...] = ()
    slopes_evidence: tuple[SlopesEvidence, ...] = ()
    relief_evidence: tuple[ReliefEvidence, ...] = ()
    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None
    camera: Camera | None = None


class StrategyOutputs(Ports):
    """The map's new depth, how sure it is, and with which weight each cue entered it, in the ports' order."""

    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"]
    depth_weights: tuple[Confidence[Array, "H W"], ...]


class Opinions(NamedTuple):
    """What K cues say.

    Attributes
    ----------
    values
        Disparity, float32 (K, H, W), px of the level; 0 where a cue abstains.
    precision
        reliability / σ², float32 (K, H, W), px⁻²; 0 where a cue abstains.
    reached
        Neighbours on the same side, uint8 (H, W), as of :func:`visint.fields.barriers.links`.
    before
        The map's disparity, float32 (H, W), NaN unknown.
    camera
        Of the level.
    """

    values: Array
    precision: Array
    reached: Array
    before: Array
    camera: Camera

    @property
    def total(self) -> Array:
        """The precision of all cues together, float32 (H, W)."""
        return np.asarray(self.precision.sum(axis=0), dtype=np.float32)

    @property
    def shares(self) -> Array:
        """The precision of each over that of all, float32 (K, H, W); 0 where nobody speaks."""
        return self.precision / np.maximum(self.total, np.float32(1e-30))

    @property
    def mean(self) -> Array:
        """The mean weighted by precision (Eq. 5.10), float32 (H, W); 0 where nobody speaks."""
        return np.asarray((self.shares * self.values).sum(axis=0), dtype=np.float32)


def gathered(inputs: StrategyInputs) -> Opinions:
    """The opinion of every cue, in the order of the ports."""
    rows, columns = inputs.depth.shape
    camera = inputs.camera or Camera.uncalibrated(columns, rows)
    reached = barriers.links(inputs.boundaries, inputs.depth.shape)
    before = disparity_of(inputs.depth, camera)
    said = [*_of_depth(inputs, camera), *_of_shape(inputs, camera, reached)]
    empty = np.zeros((0, rows, columns), np.float32)
    values = np.stack([value for value, _ in said]) if said else empty
    precision = np.stack([weight for _, weight in said]) if said else empty
    return Opinions(values, precision, reached, before, camera)


Opinion = tuple[Array, Array]


def _of_depth(inputs: StrategyInputs, camera: Camera) -> Iterator[Opinion]:
    for depth in inputs.depth_evidence:
        yield _weighed(depth, depth.value, depth.sigma, camera)
    for disparity in inputs.disparity_evidence:
        yield _measured(disparity.value, disparity.sigma, disparity.reliability)


def _of_shape(inputs: StrategyInputs, camera: Camera, reached: Array) -> Iterator[Opinion]:
    """σ of a bend is half of what a slope has: it is a quarter of two differences of slopes."""
    own = inputs.depth + barriers.bend(inputs.depth, reached)
    for normals in inputs.normals_evidence:
        slopes = slopes_from_normals(inputs.depth, normals.value, camera)
        sigma = normals.sigma * inputs.depth / np.float32(2 * camera.focal_length)
        yield _weighed(normals, own - barriers.bend_of_slopes(slopes, reached), sigma, camera)
    for slope in inputs.slopes_evidence:
        yield _weighed(slope, own - barriers.bend_of_slopes(slope.value, reached), slope.sigma / 2, camera)
    for relief in inputs.relief_evidence:
        yield _weighed(relief, own - barriers.bend(relief.value, reached), relief.sigma, camera)


def _weighed(evidence: Evidence, depth: Array, sigma: Array, camera: Camera) -> Opinion:
    """A depth and its σ, in the unit of the baseline, as an opinion on disparity."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return _measured(
            disparity_of(depth, camera), sigma / depth_per_pixel(depth, camera), evidence.reliability
        )


def _measured(value: Array, sigma: Array, reliability: Array) -> Opinion:
    speaks = (reliability > 0) & np.isfinite(value) & np.isfinite(sigma)
    spread = np.maximum(np.where(speaks, sigma, np.float32(1)), np.float32(SHARPEST))
    weight = np.where(speaks, reliability, np.float32(0)) / (spread * spread)
    return np.where(speaks, value, np.float32(0)), weight


def answered(
    inputs: StrategyInputs, opinions: Opinions, disparity: Array, weights: Array, precision: Array, scale: int
) -> StrategyOutputs:
    """The map after a strategy.

    Parameters
    ----------
    disparity
        float32 (H, W), px of the level; where it is NaN or has no depth the map stays.
    weights
        (K, H, W) in [0, 1]: how much of it each cue is.
    precision
        (H, W), px⁻² of the level; 0 leaves the map's confidence as it is.
    scale
        Full-size pixels of one of the level: the confidence is told in those.
    """
    depth = depth_from_disparity(disparity.astype(np.float32), opinions.camera)
    new = np.isfinite(depth) & (precision > 0)
    sure = inputs.depth_confidence
    before = np.zeros(depth.shape, np.float32) if sure is None else sure
    with np.errstate(divide="ignore"):
        after = confidence_of(np.float32(scale * scale) / np.maximum(precision, 0).astype(np.float32))
    return StrategyOutputs(
        depth=np.where(np.isfinite(depth), depth, inputs.depth).astype(np.float32),
        depth_confidence=np.where(new, after, before),
        depth_weights=tuple(np.clip(each, 0, 1).astype(np.float32) for each in weights),
    )
