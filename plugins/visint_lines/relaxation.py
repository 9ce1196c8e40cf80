"""Probabilistic relaxation in two epochs, as published and with catalogue rows as the labels of junctions.

Junctions and arcs take turns (Eq. 4.10, 4.11): in its epoch each side starts from its priors and moves towards
what the other side, held fast, supports. Support is averaged over neighbours, so that 1 + Δ stays positive.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_lines.catalogue import FLIP, KINDS, LABELS, catalogue, legal, slots
from visint_lines.diagram import Diagram, Junction

__all__ = ["Relaxed", "published", "rows"]

SETTLING = 10
"""Updates in an epoch."""
ROUNDS = 10
"""Rounds of both epochs at most; two to four do."""
UNDIRECTED = ("convex", "concave", "occluding", "limb", "mark")
AWKWARD = -0.5
"""Compatibility of a mark with a row of the catalogue, which knows none."""


class Relaxed(NamedTuple):
    """``arcs``: float (A, K), probabilities of the arcs' labels; ``junctions``: of each junction's types."""

    arcs: Array
    junctions: tuple[dict[str, float], ...]


class _Corner(NamedTuple):
    """A junction in a relaxation: prior over its labels, its arcs, and for each arc r(label, arc's label)."""

    prior: Array
    arcs: tuple[int, ...]
    agrees: tuple[Array, ...]
    names: tuple[str, ...]


def published(diagram: Diagram, arcs: Array, types: Sequence[Mapping[str, float]]) -> Relaxed:
    """The two-epoch relaxation of section 4.1.3 over types of junctions and undirected labels.

    Compatibility r is +1 where a label occurs in some row of the type, −1 where in none, 0 for marks.

    Parameters
    ----------
    arcs
        float (A, 5): priors of convex, concave, occluding, limb and mark.
    types
        For each junction the priors of its types.
    """
    corners = [_by_type(junction, prior) for junction, prior in zip(diagram.junctions, types, strict=True)]
    return _relaxed(corners, arcs, decided=True)


def rows(diagram: Diagram, arcs: Array, types: Sequence[Mapping[str, float]]) -> Relaxed:
    """The same relaxation with rows of the catalogue as a junction's labels, and directed labels of arcs.

    r is +1 where the row says the arc's label, −1 where another, −½ for marks.

    Parameters
    ----------
    arcs
        float (A, 7): priors of :data:`visint_lines.catalogue.LABELS`.
    """
    corners = [_by_row(junction, prior) for junction, prior in zip(diagram.junctions, types, strict=True)]
    return _relaxed(corners, arcs, decided=False)


@cache
def _occurring(kind: str) -> Array:
    """(5,): compatibility of a type with each undirected label."""
    known = {KINDS[label] for row in catalogue().get(kind, ()) for label in row}
    return np.array([0.0 if label == "mark" else 1.0 if label in known else -1.0 for label in UNDIRECTED])


def _by_type(junction: Junction, prior: Mapping[str, float]) -> _Corner:
    names = tuple(prior)
    table = np.array([_occurring(kind) for kind in names]).reshape(len(names), len(UNDIRECTED))
    ends = tuple(spoke.arc for spoke in junction.spokes)
    return _Corner(np.array([prior[kind] for kind in names]), ends, (table,) * len(ends), names)


def _by_row(junction: Junction, prior: Mapping[str, float]) -> _Corner:
    said: list[tuple[str, float, tuple[str, ...]]] = []
    for kind, share in prior.items():
        order, known = slots(kind, junction.angles), sorted(legal(kind))
        for row in known:
            away = tuple(row[order.index(i)] for i in range(len(order)))
            said.append((kind, share / len(known), away))
    agrees = []
    for i, spoke in enumerate(junction.spokes):
        walked = [away[i] if spoke.outward else FLIP[away[i]] for _, _, away in said]
        table = [
            [AWKWARD if label == "x" else 1.0 if label == own else -1.0 for label in LABELS] for own in walked
        ]
        agrees.append(np.array(table).reshape(len(said), len(LABELS)))
    names = tuple(kind for kind, _, _ in said)
    ends = tuple(spoke.arc for spoke in junction.spokes)
    return _Corner(np.array([share for _, share, _ in said]), ends, tuple(agrees), names)


def _relaxed(corners: Sequence[_Corner], arcs: Array, decided: bool) -> Relaxed:
    """Rounds of a junction and an arc epoch until no junction's nor arc's best label changes."""
    held = arcs
    before: object = None
    beliefs = [corner.prior for corner in corners]
    for _ in range(ROUNDS):
        beliefs = [_corner_epoch(corner, held) for corner in corners]
        told = [_one_hot(belief) if decided else belief for belief in beliefs]
        held = _arc_epoch(corners, told, arcs)
        state = ([int(b.argmax()) for b in beliefs if b.size], held.argmax(axis=1).tolist())
        if state == before:
            break
        before = state
    return Relaxed(held, tuple(_by_name(c, b) for c, b in zip(corners, beliefs, strict=True)))


def _one_hot(belief: Array) -> Array:
    """The tentative label that an epoch ends with."""
    told = np.zeros_like(belief)
    if belief.size:
        told[belief.argmax()] = 1.0
    return told


def _corner_epoch(corner: _Corner, arcs: Array) -> Array:
    if not corner.prior.size:
        return corner.prior
    support = sum((table @ arcs[a] for a, table in zip(corner.arcs, corner.agrees, strict=True)), 0.0)
    return np.asarray(_moved(corner.prior[None], np.asarray(support)[None] / len(corner.arcs))[0])


def _arc_epoch(corners: Sequence[_Corner], beliefs: Sequence[Array], prior: Array) -> Array:
    support, ends = np.zeros_like(prior), np.zeros(len(prior))
    for corner, belief in zip(corners, beliefs, strict=True):
        for arc, table in zip(corner.arcs, corner.agrees, strict=True):
            if belief.size:
                support[arc] += belief @ table
                ends[arc] += 1
    return _moved(prior, support / np.maximum(ends, 1)[:, None])


def _moved(prior: Array, support: Array) -> Array:
    """Eq. 4.10, ``SETTLING`` times; ``support`` lies in [−1, 1]."""
    belief = prior
    for _ in range(SETTLING):
        belief = belief * (1 + support)
        total = belief.sum(axis=1, keepdims=True)
        belief = np.where(total > 0, belief / np.where(total > 0, total, 1), prior)
    return np.asarray(belief)


def _by_name(corner: _Corner, belief: Array) -> dict[str, float]:
    told: dict[str, float] = {}
    for name, share in zip(corner.names, belief, strict=True):
        told[name] = told.get(name, 0.0) + float(share)
    return told
