"""Pull: how far a map moved from one snapshot to the next towards what a cue said."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import geometry
from visint.fields.evidence import Evidence, known
from visint.fields.snapshot import MapSnapshot

__all__ = ["AGREES", "pull"]

AGREES = 0.05
"""Nearer to the evidence than this many sigmas the map agrees with it, and no move counts as a pull."""

_READ_AS = {
    "Depth": "depth",
    "Disparity": "disparity",
    "Normals": "normals",
    "Slopes": "slopes",
    "Relief": "slopes",
    "Boundaries": "boundaries",
}


def pull(before: MapSnapshot, after: MapSnapshot, field: str, evidence: Evidence) -> Array:
    """The share of the way towards ``evidence`` that the map went, float32 (H, W) in [0, 1].

    Measured in the evidence's own terms: (new − old)·(said − old) / |said − old|², depth seen as disparity,
    normals or slopes where that is what the cue speaks of; relief by its slopes, to scale. 1 where the field
    was unknown and is known now. Where the two cannot be compared it is the rise of the map's confidence over
    what was left to rise. 0 where the cue abstains, and where the map agreed with it already.
    """
    speaks = evidence.reliability > 0
    if not speaks.any():
        return np.zeros(speaks.shape, np.float32)
    old, new = _seen_as(before, field, evidence), _seen_as(after, field, evidence)
    if new is None:
        return _risen(before, after, field, evidence)
    if old is None:
        return (speaks & known(new)).astype(np.float32)
    said = _said(evidence, old)
    way, went = _difference(said, old), _difference(new, old)
    length = _dot(way, way)
    far = speaks & (length > (AGREES * evidence.sigma) ** 2)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(_dot(went, way) / length, 0, 1)
    share = np.where(far, share, np.float32(0))
    found = speaks & ~known(old) & known(new)
    return np.asarray(np.nan_to_num(np.where(found, np.float32(1), share)), dtype=np.float32)


def _seen_as(snapshot: MapSnapshot, field: str, evidence: Evidence) -> Array | None:
    """The map in the terms of the evidence, None if it has none."""
    name = _READ_AS.get(evidence.measures, field)
    stored = snapshot.kinds.get(name)
    if name not in ("disparity", "normals", "slopes") and (stored is None or stored.name != evidence.measures):
        return None
    value: Array | None = snapshot.read(name)
    return value if value is None or value.shape == evidence.value.shape or name == "slopes" else None


def _said(evidence: Evidence, old: Array) -> Array:
    """What the cue says; relief as slopes, by the factor that fits the map's best."""
    if evidence.measures != "Relief":
        value: Array = evidence.value
        return value
    slopes = geometry.slopes_from_depth(evidence.value)
    both = known(slopes) & known(old)
    fit, size = float((slopes[both] * old[both]).sum()), float((slopes[both] ** 2).sum())
    return slopes * np.float32(fit / size if fit > 0 else 1.0)


def _difference(one: Array, other: Array) -> Array:
    return one ^ other if one.dtype == bool else one - other


def _dot(one: Array, other: Array) -> Array:
    """float32 (H, W): the product, channels summed."""
    product = (one & other).astype(np.float32) if one.dtype == bool else one * other
    return product if product.ndim == 2 else np.asarray(product.sum(axis=-1))


def _risen(before: MapSnapshot, after: MapSnapshot, field: str, evidence: Evidence) -> Array:
    nothing = np.zeros(evidence.reliability.shape, np.float32)
    low, high = before.confidence.get(field), after.confidence.get(field)
    if high is None or high.shape != nothing.shape:
        return nothing
    low = nothing if low is None else low
    with np.errstate(invalid="ignore", divide="ignore"):
        risen = np.clip((high - low) / (1 - low), 0, 1)
    return np.where(evidence.reliability > 0, np.nan_to_num(risen), nothing).astype(np.float32)
