"""What a junction says of its arcs: a table over their labels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import product
from math import exp, log
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_lines.catalogue import FLIP, LABELS, legal, slots
from visint_lines.diagram import Diagram, Junction

__all__ = ["NEVER", "Factor", "best_type", "factors_of"]

NEVER = -400.0
"""The logarithm that stands for impossible: finite, so that sums stay numbers."""
NEAR = 0.3
"""What two junctions too near to be told apart are worth beside one."""
MARKED = 0.2
"""What a junction with marks among its lines is worth beside one without."""


class Factor(NamedTuple):
    """Log weights (7, …) of the labels of a few arcs, one axis an arc, as each is walked from start to end."""

    arcs: tuple[int, ...]
    table: Array


def factors_of(diagram: Diagram, priors: Sequence[Mapping[str, float]], illegal: float) -> list[Factor]:
    """The factor of every junction that constrains its arcs.

    Parameters
    ----------
    priors
        For each junction the probabilities of its types; empty is no constraint.
    illegal
        Weight of labels that no row of a type allows, beside 1; 0 forbids them.
    """
    made = []
    for junction, prior in zip(diagram.junctions, priors, strict=True):
        if prior:
            arcs = tuple(dict.fromkeys(spoke.arc for spoke in junction.spokes))
            made.append(Factor(arcs, _table(junction, arcs, prior, illegal)))
    return made


def _table(junction: Junction, arcs: tuple[int, ...], prior: Mapping[str, float], illegal: float) -> Array:
    table = np.empty((len(LABELS),) * len(arcs))
    for choice in product(range(len(LABELS)), repeat=len(arcs)):
        walked = dict(zip(arcs, (LABELS[i] for i in choice), strict=True))
        away = tuple(walked[s.arc] if s.outward else FLIP[walked[s.arc]] for s in junction.spokes)
        weight = max(prior[kind] * (1.0 if fits(kind, away, junction.angles) else illegal) for kind in prior)
        if "T" in prior and _two_in_one(away, junction.angles):
            weight = max(weight, NEAR * (prior["T"] + prior["R"]))
        if "x" in away and weight < MARKED:
            weight = max(weight, _marked(away, junction.angles, prior, illegal))
        table[choice] = log(weight) if weight > exp(NEVER) else NEVER
    return table


@cache
def _close_by() -> frozenset[tuple[str, ...]]:
    """Rows of a T with a curvature-L or a phantom so near on its bar that the image shows one junction."""
    changes = legal("C") | legal("P")
    onward: dict[str, set[str]] = {label: {q for p, q in changes if FLIP[p] == label} for label in LABELS}
    bars = legal("T")
    first = {(one, stem, two) for bar, stem, two in bars for one in onward[bar]}
    second = {(one, stem, two) for one, stem, bar in bars for two in onward[bar]}
    return frozenset((first | second) - bars)


def _two_in_one(away: tuple[str, ...], angles: tuple[float, ...]) -> bool:
    return tuple(away[i] for i in slots("T", angles)) in _close_by()


def _marked(
    away: tuple[str, ...], angles: tuple[float, ...], prior: Mapping[str, float], illegal: float
) -> float:
    """The weight of a junction where some lines are marks: what is left must make sense without them."""
    rest = [i for i, label in enumerate(away) if label != "x"]
    if not rest:
        return MARKED
    if len(rest) == len(away) - 1 and len(rest) == 2:
        pair = tuple(away[i] for i in rest)
        bent = tuple(angles[i] for i in rest)
        if prior.get("T", 0.0) and 1 not in (slots("T", angles).index(i) for i in rest):
            return max(prior["T"] * _through(pair), MARKED * illegal)
        return MARKED * max(0.5 * fits("L", pair, bent), 0.5 * _through(pair), illegal)
    return MARKED * illegal


def _through(pair: tuple[str, ...]) -> float:
    """1 if a line goes on as it came."""
    return float(pair[0] == FLIP[pair[1]])


@cache
def fits(kind: str, away: tuple[str, ...], angles: tuple[float, ...]) -> bool:
    """Whether labels, walking away from a junction, make a row of a type of junction with these directions."""
    return tuple(away[i] for i in slots(kind, angles)) in legal(kind)


def best_type(
    junction: Junction, labels: Sequence[str], prior: Mapping[str, float], illegal: float
) -> tuple[str, bool, dict[str, float]]:
    """(type, whether the labels are a row of it, probabilities of the types) given every arc's label."""
    count = len(junction.spokes)
    if not prior:
        return ("frame" if junction.frame else "M" if count > 3 else "-", True, {})
    away = tuple(labels[s.arc] if s.outward else FLIP[labels[s.arc]] for s in junction.spokes)
    allowed = {kind: fits(kind, away, junction.angles) for kind in prior}
    weight = {kind: share * (1.0 if allowed[kind] else illegal) for kind, share in prior.items()}
    if "T" in prior and not any(allowed.values()) and _two_in_one(away, junction.angles):
        allowed["T"], weight["T"] = True, NEAR * (prior["T"] + prior["R"])
    if "x" in away and not any(allowed.values()):
        weight = dict(prior)
        allowed = {kind: _marked(away, junction.angles, prior, 0.0) > 0 for kind in prior}
    total = sum(weight.values()) or 1.0
    kind = max(weight, key=lambda one: weight[one])
    return kind, allowed[kind], {one: share / total for one, share in weight.items()}
