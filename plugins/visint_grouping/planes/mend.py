"""``grouping.mend``: a matching whose holes are filled by planes, and how sure each pixel then is."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from visint.arrays import Array, Mask
from visint.fields import DisparityEvidence
from visint.module import Context, Module, Params, Ports
from visint_grouping.planes.odds import TrainedOn, chance, log_odds

__all__ = ["Mend", "MendInputs", "mend_signs"]

WEIGHTS: Mapping[TrainedOn, tuple[float, ...]] = {
    "all": (-0.137, 0.732, 0.178, 0.400, 0.234, -0.961, -0.058, -0.471, -0.582),
    "A": (-0.192, 0.968, 0.227, 0.620, 0.226, -0.480, -0.067, -0.405, -0.469),
    "B": (-0.226, 0.823, 0.295, 0.421, 0.152, -1.325, -0.065, -0.410, -0.666),
}
BIAS: Mapping[TrainedOn, float] = {"all": 1.520, "A": 0.802, "B": 1.678}
"""Of a disparity right to 2 px, fitted as those of ``grouping.planes`` are."""
FAR = 8.0


class MendParams(Params):
    """Parameters of ``grouping.mend``.

    Parameters
    ----------
    trained_on
        Pairs the reliability was fitted on: ``all``, or half of them, to measure it fairly on the other half.
    """

    trained_on: TrainedOn = "all"


class MendInputs(Ports):
    """``evidence``: a dense matching, ``consistent`` where both views agree on it: that is kept as it is.

    ``planes``: ``grouping.planes`` of it. ``earlier``: the first of two matchings, made without planes.
    """

    evidence: DisparityEvidence
    planes: DisparityEvidence
    consistent: Mask[Array, "H W"]
    earlier: DisparityEvidence | None = None


class MendOutputs(Ports):
    """``disparity``: the matching where consistent, else the plane, else the matching's own filling."""

    disparity: DisparityEvidence


class Mend(Module[MendParams, MendInputs, MendOutputs]):
    """Disparity with its holes filled by the planes of regions, and a reliability that knows of both.

    What both views agree on is never overwritten: planes of regions are wrong on whatever is curved or
    cluttered. A second matching that followed planes agrees between the views by construction, so its own
    reliability is too high; the first one's, and how far the two lie apart, correct that.
    """

    name = "mend"
    assumptions = ("smoothness", "opacity")

    def run(self, inputs: MendInputs, ctx: Context) -> MendOutputs:
        """The mended map."""
        ctx.check()
        given, planes = inputs.evidence, inputs.planes
        taken = ~inputs.consistent & (planes.reliability > 0)
        value = np.where(taken, planes.value, given.value)
        trust = chance(
            mend_signs(inputs, value, taken), WEIGHTS[self.params.trained_on], BIAS[self.params.trained_on]
        )
        known = np.isfinite(value) & (given.reliability > 0)
        ctx.measure("filled by planes", float(taken.mean()))
        return MendOutputs(
            disparity=DisparityEvidence.of(value, np.where(taken, planes.sigma, given.sigma), known * trust)
        )


def mend_signs(inputs: MendInputs, value: Array, taken: Array) -> Array:
    """float32 (9, H, W): signs of a right disparity.

    How sure this matching and the earlier are; whether both views agree; how sure the plane is where it was
    taken and where not; whether there is none; how far the result lies from the earlier matching, the square
    root of that, and the square root of how far it lies from the plane.
    """
    earlier = inputs.evidence if inputs.earlier is None else inputs.earlier
    planes = inputs.planes
    none = planes.reliability <= 0
    sure = np.where(none, 0, log_odds(planes.reliability))
    off = np.minimum(np.nan_to_num(np.abs(value - earlier.value), nan=FAR), FAR)
    apart = np.minimum(np.nan_to_num(np.abs(value - planes.value), nan=0), FAR)
    return np.stack(
        [
            log_odds(inputs.evidence.reliability),
            log_odds(earlier.reliability),
            inputs.consistent,
            sure * taken,
            sure * ~taken,
            none,
            off,
            np.sqrt(off),
            np.sqrt(apart),
        ]
    ).astype(np.float32)
