"""``bayes.fault_lattice``: where cues contradict each other, which premises are given up; section 2.9."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import Field, field_validator

from visint.arrays import Array
from visint.fields.assumptions import check_names
from visint.module import Context, Module, Params
from visint_bayes.strategies.lattice import Nogood, preferred
from visint_bayes.strategies.opinions import Opinions, StrategyInputs, StrategyOutputs, answered, gathered

__all__ = ["FaultLattice"]

Names = tuple[str, ...]


class FaultLatticeParams(Params):
    """Parameters of ``bayes.fault_lattice``.

    Parameters
    ----------
    premises
        For each evidence, in the order of the ports, what it rests on: names of assumptions, as
        ``visint modules ID`` lists them for the cue's module. A cue without any rests on itself.
    contradict
        Two cues contradict each other where they differ by more than this many of their σ together.
    choose
        Between what can hold together: ``votes``, the most premises; ``priority``, the earliest of ``trusted``.
    trusted
        Premises from the one that is given up last; those not named come behind.
    """

    premises: tuple[Names, ...] = ()
    contradict: float = Field(default=3.0, gt=0)
    choose: Literal["votes", "priority"] = "votes"
    trusted: Names = ()

    @field_validator("premises")
    @classmethod
    def _known(cls, premises: tuple[Names, ...]) -> tuple[Names, ...]:
        for names in premises:
            check_names(names)
        return premises


class FaultLattice(Module[FaultLatticeParams, StrategyInputs, StrategyOutputs]):
    """Pixel by pixel, the cues whose premises can all hold; their mean is the depth.

    After Jepson and Richards; section 2.9. Two cues that contradict each other cannot both have all their
    premises right. Of the largest sets of premises without such a pair one is chosen, and with it the cues
    whose premises are all in it; what they say is averaged by precision (Eq. 5.10). A cue that errs without
    violating a premise misleads the lattice: it believes modules that keep their word.
    """

    name = "fault_lattice"
    assumptions = ("gaussian_noise",)

    def run(self, inputs: StrategyInputs, ctx: Context) -> StrategyOutputs:
        """The map by the cues that were believed; ``<premise> given up`` is the share of pixels."""
        ctx.check()
        opinions = gathered(inputs)
        premises = self._premises(len(opinions.values))
        believed, given_up = self._believed(opinions, premises)
        for name, share in given_up.items():
            ctx.measure(f"{name} given up", share)
        precision = opinions.precision * believed
        kept = opinions._replace(precision=precision)
        total = kept.total
        disparity = np.where(total > 0, kept.mean, opinions.before)
        return answered(inputs, opinions, disparity, kept.shares, total, ctx.scale)

    def _premises(self, count: int) -> list[frozenset[str]]:
        given = self.params.premises[:count] + ((),) * (count - len(self.params.premises))
        return [frozenset(names) or frozenset({f"cue {i + 1}"}) for i, names in enumerate(given)]

    def _believed(
        self, opinions: Opinions, premises: Sequence[frozenset[str]]
    ) -> tuple[Array, dict[str, float]]:
        """bool (K, H, W): whom to believe; and the share of pixels at which each premise is given up."""
        pairs, contradictions = _contradictions(opinions, self.params.contradict)
        believed = opinions.precision > 0
        given_up: dict[str, float] = {}
        patterns, where = np.unique(contradictions, return_inverse=True)
        where = where.reshape(contradictions.shape)
        for index, pattern in enumerate(patterns.tolist()):
            if pattern == 0:
                continue
            here = where == index
            clashes = [premises[i] | premises[j] for k, (i, j) in enumerate(pairs) if pattern >> k & 1]
            involved = sorted({i for k, pair in enumerate(pairs) if pattern >> k & 1 for i in pair})
            of_those = frozenset().union(*(premises[i] for i in involved))
            chosen = self._chosen(of_those, [Nogood(clash) for clash in clashes])
            for i in involved:
                if not premises[i] <= chosen:
                    believed[i][here] = False
            for name in sorted(of_those - chosen):
                given_up[name] = given_up.get(name, 0.0) + float(here.mean())
        return believed, given_up

    def _chosen(self, premises: frozenset[str], clashes: Sequence[Nogood]) -> frozenset[str]:
        return preferred(premises, clashes, self.params.choose, self.params.trusted)


def _contradictions(opinions: Opinions, limit: float) -> tuple[list[tuple[int, int]], Array]:
    """The pairs of cues, and int64 (H, W) whose bit k says that pair k contradicts each other."""
    count = len(opinions.values)
    pairs = [(i, j) for i in range(count) for j in range(i)]
    found = np.zeros(opinions.before.shape, np.int64)
    variance = np.where(opinions.precision > 0, 1 / np.maximum(opinions.precision, np.float32(1e-30)), 0)
    for k, (i, j) in enumerate(pairs):
        both = (opinions.precision[i] > 0) & (opinions.precision[j] > 0)
        apart = np.abs(opinions.values[i] - opinions.values[j])
        clash = both & (apart > np.float32(limit) * np.sqrt(variance[i] + variance[j]))
        found |= clash.astype(np.int64) << k
    return pairs, found
