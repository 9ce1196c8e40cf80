"""``bayes.description_length``: the surface that takes the fewest bits to describe, section 2.6."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array
from visint.module import Context, Module, Params
from visint_bayes.strategies.opinions import StrategyInputs, StrategyOutputs, answered, gathered

__all__ = ["DescriptionLength"]


class DescriptionLengthParams(Params):
    """Parameters of ``bayes.description_length``.

    Parameters
    ----------
    language
        What a run of disparities along a row is: ``constant``, or a ``line``, which a plane is.
    bits
        Of a run: where it begins and what it is. More makes longer runs.
    at_boundary
        Of a run that begins where the map has a boundary already.
    both_ways
        Rows first, then columns of what the rows say; else rows alone.
    """

    language: Literal["constant", "line"] = "line"
    bits: float = Field(default=24.0, ge=0)
    at_boundary: float = Field(default=12.0, ge=0)
    both_ways: bool = True


class DescriptionLength(Module[DescriptionLengthParams, StrategyInputs, StrategyOutputs]):
    """Minimum description length: runs of disparity along rows, then along columns.

    J. Rissanen, Automatica 14(5), 1978, doi:10.1016/0005-1098(78)90005-5; for images Y. G. Leclerc, IJCV 3(1),
    1989, doi:10.1007/BF00054839. A run costs ``bits``, what it leaves of the cues' mean d costs
    β (f − d)² / 2 · log₂ e, the length of a Gaussian code. The breakpoints of a row of least length are found
    exactly, by dynamic programming. What is not exact is the plane: a description by rows does not know of the
    next row, and the columns that follow mend only part of that.
    """

    name = "description_length"
    assumptions = ("piecewise_continuity", "gaussian_noise", "opacity")

    def run(self, inputs: StrategyInputs, ctx: Context) -> StrategyOutputs:
        """The map so described; ``bits`` is its length by rows."""
        ctx.check()
        opinions = gathered(inputs)
        total = opinions.total
        field, bits = self._described(opinions.mean, total, inputs.boundaries)
        ctx.measure("bits", bits)
        ctx.check()
        if self.params.both_ways:
            lines = None if inputs.boundaries is None else inputs.boundaries.T
            said = np.where(total > 0, field, 0).astype(np.float32)
            field = self._described(said.T, total.T, lines)[0].T
        disparity = np.where(total > 0, field, opinions.before)
        return answered(inputs, opinions, disparity, opinions.shares, total, ctx.scale)

    def _described(self, said: Array, weight: Array, lines: Array | None) -> tuple[Array, float]:
        """(field float64 (H, W), bits) of the rows of ``said``."""
        from visint_bayes.strategies import _kernels

        price = np.full(said.shape, float(self.params.bits))
        if lines is not None:
            price[lines] = self.params.at_boundary
        fitted = np.empty(said.shape)
        said, weight = np.ascontiguousarray(said), np.ascontiguousarray(weight)
        return fitted, float(_kernels.describe(said, weight, price, self.params.language == "line", fitted))
