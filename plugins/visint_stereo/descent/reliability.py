"""The left field as evidence: sigma from precision, reliability from precision, agreement and residual."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import DisparityEvidence
from visint_stereo.descent.judgement import Judgement

__all__ = ["evidence_of", "reliability", "sigma_of", "signs", "tested"]

SLIGHT = 1.0
"""Σ w R² that two equal views differ by all the same, squared scaled grades."""
WIDEST = 100.0
"""Sigma is cut here, px."""
TOO_WIDE = 5.0
"""A match of this sigma, px, rests on its neighbours alone: its reliability is halved."""

UNLIKE = 100.0
"""Σ w R² from which on two places do not look alike: ten grades, twice the usual noise."""

WEIGHTS = np.array([-0.768, -0.665, -0.567], dtype=np.float32)
BIAS = np.float32(2.496)
"""Fitted to errors below 1 px on rendered and real pairs; see the stereo page of the documentation."""


def sigma_of(judgement: Judgement) -> Array:
    """float32 (H, W): √(σ² / Σ w J²) around the pixel (Eq. 5.102), px; the window counts as one measurement."""
    precision = judgement.support / (judgement.error + SLIGHT)
    return np.asarray(1 / np.sqrt(np.maximum(precision, WIDEST**-2)), dtype=np.float32)


def signs(judgement: Judgement) -> Array:
    """float32 (3, H, W): log sigma, gap between the two views (at most 4 px), log residual."""
    gap = np.minimum(np.nan_to_num(judgement.gap, nan=4.0), 4)
    return np.stack([np.log(sigma_of(judgement)), gap, np.log1p(judgement.error)])


def reliability(judgement: Judgement) -> Array:
    """float32 (H, W) in [0, 1): the chance that the disparity is right to a pixel.

    Next to 0 without texture around, 0 without any, and 0 where the match lies outside the other image.
    """
    odds = np.tensordot(WEIGHTS, signs(judgement), axes=1) + BIAS
    alone = (sigma_of(judgement) / TOO_WIDE) ** 2
    speaks = (judgement.support > 0) & np.isfinite(judgement.gap)
    return np.asarray(np.where(speaks, 1 / ((1 + np.exp(-odds)) * (1 + alone)), 0), dtype=np.float32)


def tested(judgement: Judgement) -> dict[str, Array]:
    """Where two premises hold, bool (H, W) each: enough texture around, and equal brightness of both views."""
    precise = judgement.support * TOO_WIDE**2 >= judgement.error + SLIGHT
    return {"sufficient_context": precise, "brightness_constancy": judgement.error <= UNLIKE}


def evidence_of(field: Array, judgement: Judgement) -> DisparityEvidence:
    """``field`` with its sigma and its reliability."""
    return DisparityEvidence.of(field, sigma_of(judgement), reliability(judgement))
