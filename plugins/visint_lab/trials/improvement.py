"""Improvements over the same stereo alone, and the controls without which they say nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median

from visint_lab.datasets.pair import Pair
from visint_lab.render.rendering import Rendering, render
from visint_lab.scenes import scene
from visint_lab.trials.published import ImprovementTable, Row
from visint_lab.trials.reconstruction import Reconstruction, constant_plane, scored
from visint_lab.trials.systems import (
    SystemVariant,
    baseline_of,
    controls_of,
    cues_of,
    installed,
    reconstruct,
)

__all__ = ["Outcome", "Reduction", "RowResult", "improvements", "variants_of"]


@dataclass(frozen=True)
class Reduction:
    """Reduction of squared shape and depth error, %, over the baseline; negative is worse."""

    shape: float
    depth: float


@dataclass(frozen=True, eq=False)
class Outcome:
    """One scene from one seed: scores by system, and the maps behind them."""

    pair: Rendering
    scores: Mapping[str, Mapping[str, float]]
    maps: Mapping[str, Reconstruction]
    baseline: str

    def reduction(self, system: str) -> Reduction:
        """Of ``system`` over this outcome's baseline."""
        own, before = self.scores[system], self.scores[self.baseline]
        return Reduction(*(100 * (1 - own[key] / before[key]) for key in ("s", "mse")))


@dataclass(frozen=True, eq=False)
class RowResult:
    """A row of a table: what is published, and what came out, seed by seed."""

    row: Row
    outcomes: Sequence[Outcome] = field(default=())

    def reductions(self, system: str) -> Sequence[Reduction]:
        """One a seed; empty where the system did not run."""
        return [one.reduction(system) for one in self.outcomes if system in one.scores]

    def middle(self, system: str) -> Reduction | None:
        """The median over the seeds."""
        found = self.reductions(system)
        if not found:
            return None
        return Reduction(median(one.shape for one in found), median(one.depth for one in found))


def variants_of(system: str) -> tuple[SystemVariant, ...]:
    """The system, its amplitude-zero controls, itself without each of its cues; nothing if it is not there."""
    if not installed(system):
        return ()
    return (SystemVariant(system), *controls_of(system), *cues_of(system))


def improvements(
    table: ImprovementTable, size: int, seeds: Sequence[int | None], systems: Sequence[str]
) -> Iterator[RowResult]:
    """Row after row of ``table``.

    Parameters
    ----------
    size
        Rows and columns of the images.
    seeds
        Of poses and noise; None is the chosen pose with noise of seed 0.
    systems
        Names of graphs; the table's own is tried with all its controls, those that are not there are left out.
    """
    variants = [variant for system in systems for variant in variants_of(system)]
    baseline = baseline_of(table.system)
    for row in table.rows:
        name = f"{row.scene}+{table.noise}" if table.noise else row.scene
        outcomes = [_outcome(name, size, seed, (SystemVariant(baseline), *variants)) for seed in seeds]
        yield RowResult(row, outcomes)


def _outcome(name: str, size: int, seed: int | None, variants: Sequence[SystemVariant]) -> Outcome:
    rendering = render(scene(name, size, seed), seed=seed or 0)
    pair = Pair.of(rendering)
    maps = {str(variant): reconstruct(variant, pair, rendering.light) for variant in variants}
    floor = constant_plane(pair)
    scores = {system: scored(found, pair) for system, found in {**maps, floor.system: floor}.items()}
    return Outcome(rendering, scores, maps, str(variants[0]))
