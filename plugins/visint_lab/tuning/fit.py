"""The choice among candidates, fitted by ridge regression and judged on scenes left out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from visint.arrays import Array
from visint_lab.tuning.table import Sample

__all__ = ["Fitted", "Model", "bound", "fitted"]

FOLDS = 8
PENALTY, OWN_PENALTY = 10.0, 30.0
CAUTIONS, WARMTHS = (0.0, 0.5, 0.75, 1.0, 1.25), (0.1, 0.15, 0.3)
HARM = 2.0
"""What each scene in a hundred that is made worse costs, in points of the medians."""
WORST = 0.2
"""What each point costs that the worst scene loses."""


class Model(NamedTuple):
    """``middle``, ``spread`` (K, F) standardise signs; ``coefficients`` (2, K, F + 1) of depth and of shape."""

    middle: Array
    spread: Array
    coefficients: Array

    def predicted(self, signs: Array) -> Array:
        """(2, K) log ratios of error, from signs (K, F); NaN where a sign is not finite."""
        scaled = np.clip((signs - self.middle) / self.spread, -4, 4)
        rows = np.concatenate([scaled, np.ones((len(signs), 1))], axis=1)
        return np.asarray((self.coefficients * rows).sum(axis=2))


class Fitted(NamedTuple):
    """A model, its error on scenes left out (K,), the choice of caution and warmth, and what it gave there."""

    model: Model
    risk: Array
    caution: float
    warmth: float
    held_out: Array

    def told(self, names: Sequence[str]) -> dict[str, Any]:
        """As the plugin's data file holds it."""
        depth, shape = self.model.coefficients
        arrays = {"middle": self.model.middle, "spread": self.model.spread, "depth": depth, "shape": shape}
        rounded = {name: np.round(value, 4).tolist() for name, value in {**arrays, "risk": self.risk}.items()}
        return {"names": list(names), **rounded, "caution": self.caution, "warmth": self.warmth}


def fitted(samples: Sequence[Sample], seed: int = 0) -> Fitted:
    """The model of all samples; caution and warmth are those that did best on scenes left out in turn."""
    folds = np.random.default_rng(seed).permutation(len(samples)) % FOLDS
    guesses = np.empty((len(samples), 2, len(samples[0].signs)))
    for fold in range(FOLDS):
        model = _ridge([one for one, f in zip(samples, folds, strict=True) if f != fold])
        for place in np.nonzero(folds == fold)[0].tolist():
            guesses[place] = model.predicted(samples[place].signs)
    residual = np.array([_targets(one).T for one in samples]) - guesses
    sd = np.nanstd(residual, axis=0)
    risk = sd[0] + 0.5 * sd[1]
    gains = {key: bound(samples, guesses, risk, key) for key in product(CAUTIONS, WARMTHS)}
    caution, warmth = max(gains, key=lambda key: _worth(gains[key]))
    return Fitted(_ridge(samples), risk, caution, warmth, gains[caution, warmth])


def _worth(gains: Array) -> float:
    harmed = 100 * float((gains < -2).any(axis=1).mean())
    return float(np.median(gains, axis=0).sum() + WORST * gains.min()) - HARM * harmed


def bound(samples: Sequence[Sample], guesses: Array, risk: Array, key: tuple[float, float]) -> Array:
    """(N, 2): reductions, %, of squared depth and normal error that the blend has at least.

    The mean of surfaces errs no more than the weighted mean of their errors.
    """
    caution, warmth = key
    gains = []
    for one, guess in zip(samples, guesses, strict=True):
        cost = guess[0] + 0.5 * guess[1] + caution * risk
        pull = np.nan_to_num(np.exp(-cost / warmth))
        parts = pull / (pull.sum() + 1)
        parts = np.where(parts < 0.02, 0, parts)
        gains.append(100 * (1 - parts @ one.ratios - (1 - parts.sum())))
    return np.array(gains)


def _targets(one: Sample) -> Array:
    """(K, 2): log ratios, cut where more or less makes no difference to the choice."""
    return np.clip(np.log(np.maximum(one.ratios, 1e-3)), -3, 2.5)


def _ridge(samples: Sequence[Sample]) -> Model:
    signs = np.array([one.signs for one in samples])
    known = np.isfinite(signs).all(axis=2)
    clean = np.where(known[..., None], signs, np.nan)
    middle, spread = np.nanmean(clean, axis=0), np.maximum(np.nanstd(clean, axis=0), 1e-3)
    scaled = np.nan_to_num(np.clip((clean - middle) / spread, -4, 4))
    targets = np.array([_targets(one) for one in samples])
    return Model(middle, spread, np.stack([_both(scaled, targets[..., t], known) for t in range(2)]))


def _both(scaled: Array, target: Array, known: Array) -> Array:
    """(K, F + 1): coefficients that all candidates share, and each one's own on what they leave."""
    kinds, width = scaled.shape[1:]
    ones = np.broadcast_to(np.eye(kinds), (len(scaled), kinds, kinds))
    rows = np.concatenate([scaled, ones], axis=2)[known]
    shared = _solved(rows, target[known], [PENALTY] * width + [0.5] * kinds)
    out = np.empty((kinds, width + 1))
    for k in range(kinds):
        x = np.concatenate([scaled[known[:, k], k], np.ones((known[:, k].sum(), 1))], axis=1)
        common = np.append(shared[:width], shared[width + k])
        out[k] = common + _solved(x, target[known[:, k], k] - x @ common, [OWN_PENALTY] * width + [5.0])
    return out


def _solved(rows: Array, target: Array, penalty: Sequence[float]) -> Array:
    return np.asarray(np.linalg.solve(rows.T @ rows + np.diag(penalty), rows.T @ target))
