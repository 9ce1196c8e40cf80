"""Systems and peers on the same pairs, in turn, each in a fresh process with one thread."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import visint
from visint.errors import ModuleError
from visint_lab.datasets.pair import Pair
from visint_lab.peers import NAMES, run_peer
from visint_lab.trials.apart import reconstruct_apart
from visint_lab.trials.reconstruction import Reconstruction, constant_plane, scored
from visint_lab.trials.systems import SystemVariant

__all__ = ["Entrant", "Heat", "Standing", "entrants", "heats", "standings"]

Runner = Callable[[Pair, visint.Light | None], Reconstruction]


@dataclass(frozen=True)
class Entrant:
    """Somebody who reconstructs pairs."""

    name: str
    run: Runner


@dataclass(frozen=True)
class Heat:
    """One entrant on one pair: every score, ``cpu`` and ``peak_mb`` among them, or why there is none."""

    pair: str
    entrant: str
    scores: Mapping[str, float]
    failure: str = ""


@dataclass(frozen=True)
class Standing:
    """An entrant over all pairs: medians of its scores, and the number of pairs it made worse.

    ``worse`` counts against the first entrant, by the deciding score.
    """

    entrant: str
    medians: Mapping[str, float]
    means: Mapping[str, float]
    worse: int
    pairs: int


def entrants(systems: Sequence[str], peers: Sequence[str], floor: bool = True) -> tuple[Entrant, ...]:
    """Systems (graphs) first, then peers by name, then the constant plane."""
    found = [_system(name) for name in systems] + [_peer(name) for name in peers]
    if floor:
        found.append(Entrant("constant plane", _floor))
    return tuple(found)


def _floor(pair: Pair, light: visint.Light | None) -> Reconstruction:  # noqa: ARG001 - the form of a runner
    return constant_plane(pair)


def _system(name: str) -> Entrant:
    return Entrant(name, lambda pair, light: reconstruct_apart(SystemVariant(name), pair, light))


def _peer(name: str) -> Entrant:
    def run(pair: Pair, light: visint.Light | None) -> Reconstruction:  # noqa: ARG001 - peers know no light
        found = run_peer(name, pair)
        return Reconstruction.of(name, found.disparity, pair, found.cost)

    assert name in NAMES
    return Entrant(name, run)


def heats(pairs: Sequence[tuple[Pair, visint.Light | None]], field: Sequence[Entrant]) -> Iterator[Heat]:
    """Pair after pair, the entrants in turn so that a slow moment of the machine meets all of them."""
    for pair, light in pairs:
        for entrant in field:
            yield _heat(pair, light, entrant)


def _heat(pair: Pair, light: visint.Light | None, entrant: Entrant) -> Heat:
    try:
        found = entrant.run(pair, light)
    except ModuleError as error:
        return Heat(pair.name, entrant.name, {}, error.problems[0].found)
    costs = {"cpu": found.cost.cpu, "peak_mb": found.cost.peak_mb}
    return Heat(pair.name, entrant.name, {**scored(found, pair), **costs})


def standings(found: Sequence[Heat], decides: str) -> tuple[Standing, ...]:
    """One an entrant, in their order; ``decides`` is the score by which a pair counts as made worse."""
    names = list(dict.fromkeys(heat.entrant for heat in found))
    first = {heat.pair: heat.scores.get(decides, math.nan) for heat in found if heat.entrant == names[0]}
    return tuple(
        _standing(name, [heat for heat in found if heat.entrant == name], first, decides) for name in names
    )


def _standing(name: str, found: Sequence[Heat], first: Mapping[str, float], decides: str) -> Standing:
    keys = dict.fromkeys(key for heat in found for key in heat.scores)
    columns = {
        key: [heat.scores[key] for heat in found if math.isfinite(heat.scores.get(key, math.nan))]
        for key in keys
    }
    medians = {key: median(values) for key, values in columns.items() if values}
    means = {key: sum(values) / len(values) for key, values in columns.items() if values}
    worse = sum(heat.scores.get(decides, math.inf) > 1.0001 * first[heat.pair] for heat in found)
    return Standing(name, medians, means, worse, len(found))
