"""What shading rests on, and where it was found to hold."""

from __future__ import annotations

import numpy as np

from visint.module import Context
from visint_shading.photometry import Photometry

__all__ = ["PREMISES", "tell"]

PREMISES = (
    "lambertian_reflectance",
    "piecewise_constant_albedo",
    "single_light_source",
    "no_interreflection",
    "perfect_segmentation",
)


def tell(found: Photometry, ctx: Context) -> None:
    """Which premises the test of each region found held; nothing is said where there was nothing to test."""
    ctx.measure("light trust", found.light_trust)
    tested = found.agreement
    if tested is None:
        return
    labels = found.frame.whole(found.seen.labels)
    ctx.assumed("lambertian_reflectance", found.trust > 0.3, labels)
    ctx.assumed("piecewise_constant_albedo", (tested.scatter < 0.25) & (tested.grain < 0.15), labels)
    ctx.assumed("single_light_source", found.light_trust > 0.3)
    ctx.measure(
        "trusted share of regions", float(np.mean(found.trust[1:] > 0.3)) if found.trust.size > 1 else 0
    )
