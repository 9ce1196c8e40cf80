"""Weights of the candidates, learned on training scenes from signs that do not look at the truth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from visint.arrays import Array

__all__ = ["Choice", "shipped", "weights_of"]

FILE = "choice.json"


@dataclass(frozen=True, slots=True)
class Choice:
    """Linear predictors of the log of each candidate's error over the stereo's.

    Parameters
    ----------
    names
        The candidates.
    middle, spread
        (K, F): what signs are standardised by.
    depth, shape
        (K, F + 1): coefficients for the squared error of depth and of normals; the last is the constant.
    risk
        (K,): standard deviation of the prediction on scenes that were left out.
    caution, warmth
        How many of those are added to a prediction, and how sharply the better is preferred.
    """

    names: tuple[str, ...]
    middle: Array
    spread: Array
    depth: Array
    shape: Array
    risk: Array
    caution: float
    warmth: float

    @classmethod
    def of(cls, values: dict[str, Any]) -> Choice:
        """From what :func:`json.loads` gives."""
        arrays = {
            name: np.asarray(values[name], float) for name in ("middle", "spread", "depth", "shape", "risk")
        }
        return cls(tuple(values["names"]), caution=values["caution"], warmth=values["warmth"], **arrays)


@cache
def shipped(which: str) -> Choice | None:
    """The one fitted for ``lit`` or ``dark`` scenes (light known or not); None if there is none."""
    from json import loads

    from visint.io import resource_text

    known = loads(resource_text("visint_bayes", "joint", FILE))
    return Choice.of(known[which]) if which in known else None


def weights_of(choice: Choice | None, signs: Array) -> Array:
    """(K,): parts of the candidates in the blend, at most 1 together; what is missing is the stereo's.

    The mean of surfaces is never worse than the weighted mean of their squared errors. A candidate with a sign
    that is not finite gets nothing. Without a ``choice``, or with one for another pool: all equal.
    """
    if choice is None or choice.middle.shape != signs.shape:
        return np.full(len(signs), 1 / (len(signs) + 1))
    scaled = np.clip((signs - choice.middle) / choice.spread, -4, 4)
    known = np.isfinite(scaled).all(axis=1)
    rows = np.concatenate([np.nan_to_num(scaled), np.ones((len(signs), 1))], axis=1)
    cost = (rows * (choice.depth + 0.5 * choice.shape)).sum(axis=1) + choice.caution * choice.risk
    pull = np.where(known, np.exp(np.clip(-cost / choice.warmth, -50, 50)), 0)
    parts = pull / (pull.sum() + 1)
    parts = np.where(parts < 0.02, 0, parts)
    return np.asarray(parts)
