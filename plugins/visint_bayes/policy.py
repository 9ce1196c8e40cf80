"""``bayes.uniform``: which coherence and which consistency mapping go with each kind of evidence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["UNIFORM"]

Steps = Mapping[str, Mapping[str, Any]]
_NOTHING: Mapping[str, Any] = {"uses": "none"}


_SHAPE: Steps = {"cohere": {"uses": "bayes.cohere_normals"}, "reconcile": {"uses": "bayes.gradient"}}

UNIFORM: Mapping[str, Steps] = {
    "Disparity": {"cohere": {"uses": "bayes.cohere_disparity"}, "reconcile": {"uses": "bayes.depth"}},
    "Depth": {"cohere": {"uses": "bayes.cohere_depth"}, "reconcile": {"uses": "bayes.depth"}},
    "Relief": _SHAPE,
    "Normals": _SHAPE,
    "Slopes": _SHAPE,
    "Boundaries": {"cohere": {"uses": "bayes.cohere_boundaries"}, "reconcile": {"uses": "bayes.boundaries"}},
    "Incidence": {"cohere": _NOTHING, "reconcile": _NOTHING},
}
"""Brightness as such (``Incidence``) tells nothing of depth by itself: it waits for an estimate that knows the
light."""
