"""Metrics: how far a reconstruction lies from the truth. One file a family, each a function and a module.

Everywhere unknown values are NaN, ``mask`` says which pixels count, and pixels whose truth is unknown never
do. Numbers over nothing are NaN.
"""

from __future__ import annotations

from visint_lab.metrics.boundaries import BoundaryScore, boundary_scores
from visint_lab.metrics.confidence import ConfidenceScore, confidence_scores, sparsification
from visint_lab.metrics.depth import DepthScore, depth_scores
from visint_lab.metrics.disparity import DisparityScore, disparity_scores, filled_from_rows
from visint_lab.metrics.labels import LabelScore, arc_scores, junction_scores
from visint_lab.metrics.shape import ShapeScore, shape_scores

__all__ = [
    "MODULES",
    "BoundaryScore",
    "ConfidenceScore",
    "DepthScore",
    "DisparityScore",
    "LabelScore",
    "ShapeScore",
    "arc_scores",
    "boundary_scores",
    "confidence_scores",
    "depth_scores",
    "disparity_scores",
    "filled_from_rows",
    "junction_scores",
    "shape_scores",
    "sparsification",
]

MODULES = (BoundaryScore, ConfidenceScore, DepthScore, DisparityScore, LabelScore, ShapeScore)
