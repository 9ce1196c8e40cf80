"""What each cue contributes: how much larger the error is without it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from visint_lab.trials.systems import SystemVariant

__all__ = ["Contribution", "contributions"]

ERRORS = ("mse", "s", "bad1", "bad2", "mae")
"""Errors that are 0 at best: squared depth, shape, wrong pixels, mean disparity."""

Scores = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class Contribution:
    """What a system loses under a variant of itself.

    ``taken`` says what the variant lacks; ``gains`` are by error 100·(1 − whole/variant): percent of that error
    that the cue takes away, negative where it does harm; ``share`` is the mean weight in [0, 1] with which the
    cue decided depth, NaN where that is not known.
    """

    taken: str
    gains: Mapping[str, float]
    share: float


def contributions(
    whole: SystemVariant, variants: list[SystemVariant], scores: Scores, shares: Mapping[str, float]
) -> list[Contribution]:
    """One for each variant of ``whole`` that was scored, in order."""
    own = [one for one in variants if one.graph == whole.graph and one != whole and str(one) in scores]
    return [
        Contribution(_taken(one), _gains(scores[str(whole)], scores[str(one)]), _share(one, shares))
        for one in own
    ]


def _taken(variant: SystemVariant) -> str:
    return f"control {variant.control}" if variant.control else f"without {', '.join(variant.without)}"


def _share(variant: SystemVariant, shares: Mapping[str, float]) -> float:
    """Of the cues that are left out; of a control, those whose name it bears."""
    cues = variant.without or ((variant.control,) if variant.control else ())
    known = [shares[cue] for cue in cues if cue in shares]
    return sum(known) if known else float("nan")


def _gains(whole: Mapping[str, float], variant: Mapping[str, float]) -> dict[str, float]:
    return {key: _gain(whole[key], variant[key]) for key in ERRORS if key in whole and key in variant}


def _gain(whole: float, variant: float) -> float:
    if variant == whole:
        return 0.0
    return 100 * (1 - whole / variant) if variant > 0 else float("-inf")
