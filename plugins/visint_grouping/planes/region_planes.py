"""``grouping.planes``: a plane for each region, where the region's own matches or its neighbours' allow one."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from visint.arrays import Array, Color, Disparity, Image, Mask, Regions
from visint.fields import DisparityEvidence
from visint.module import Context, Module, Params, Ports
from visint_grouping.partition import complete, numbered
from visint_grouping.planes.choice import Chosen, Limits, chosen_planes
from visint_grouping.planes.laying import laid_out
from visint_grouping.planes.odds import TrainedOn
from visint_grouping.planes.trust import plane_signs, plane_trust
from visint_grouping.planes.votes import Ballot, views_of
from visint_grouping.superpixels import SuperpixelsParams, graded_colour, superpixels_in

__all__ = ["RegionPlanes", "RegionPlanesInputs", "RegionPlanesParams"]

SIGMA = 0.4
"""Standard deviation of a disparity from the plane of its region, px, where that plane is right."""
BELIEVED = 0.5
"""Reliability from which a pixel votes where nobody says which are consistent."""


class RegionPlanesParams(Params):
    """Parameters of ``grouping.planes``.

    Parameters
    ----------
    energy
        The most a plane may cost, from 0 (fits every vote, and every pixel without one looks alike in both
        views) to 1. More accepts more planes and, from 0.5 on, wrong ones.
    share
        The least share of a region's own votes that has to lie within 1 px. More keeps to plane surfaces.
    trained_on
        Pairs the reliability was fitted on: ``all``, or half of them, to measure it fairly on the other half.
    """

    energy: float = Field(default=0.43, gt=0, le=1)
    share: float = Field(default=0.6, ge=0, le=1)
    trained_on: TrainedOn = "all"


class RegionPlanesInputs(Ports):
    """A view, disparities of it, and what helps to judge planes.

    ``evidence``: from any matcher. ``consistent``: where both views agree on it; there it votes, by the square
    of its reliability; where not given, wherever reliability is at least a half. ``right_disparity``: the right
    view's, NaN where unknown: no plane may hide what that view sees. ``right``: the right view itself, which
    has to look alike. ``regions``: labels from 1, 0 unknown; else ``grouping.superpixels`` are made.
    """

    left: Image[Array, "H W"]
    evidence: DisparityEvidence
    consistent: Mask[Array, "H W"] | None = None
    right: Image[Array, "H W"] | None = None
    right_disparity: Disparity[Array, "H W"] | None = None
    color: Color[Array, "H W 3"] | None = None
    regions: Regions[Array, "H W"] | None = None


class RegionPlanesOutputs(Ports):
    """``disparity``: the planes, silent where none is accepted or a plane would hide what the right view sees.

    ``regions``: labels from 1, as used.
    """

    disparity: DisparityEvidence
    regions: Regions[Array, "H W"]


class RegionPlanes(Module[RegionPlanesParams, RegionPlanesInputs, RegionPlanesOutputs]):
    """Disparity of the plane that each region takes: its own, or that of a region up to two steps away.

    A robust fit a region; then the plane of least energy among those around: distance to the region's own
    votes, likeness of both views and visibility where it has none, likeness of colour, agreement with
    neighbours. Planes of regions as evidence: Birchfield and Tomasi, ICCV 1999, doi:10.1109/ICCV.1999.790296;
    from neighbouring segments: Bleyer and Gelautz 2005, doi:10.1016/j.isprsjprs.2005.02.008.

    Assumes that a region of like colour is nearly flat. Abstains region by region where votes or views speak
    against it; a curved surface keeps what the matcher said.
    """

    name = "planes"
    assumptions = ("smoothness", "opacity", "coherence")

    def run(self, inputs: RegionPlanesInputs, ctx: Context) -> RegionPlanesOutputs:
        """Planes of this level's regions."""
        levels = graded_colour(inputs.left, inputs.color)
        labels = _labels(inputs.regions, levels, ctx.scale)
        ctx.check()
        ballot = _ballot(inputs)
        words = None if inputs.right is None else views_of(inputs.left, inputs.right)
        chosen = chosen_planes(labels, levels, ballot, words, Limits(self.params.energy, self.params.share))
        ctx.check()
        self._tell(ctx, chosen, labels)
        return RegionPlanesOutputs(
            disparity=self._evidence(inputs, labels, chosen, ballot), regions=labels + np.int32(1)
        )

    def _evidence(
        self, inputs: RegionPlanesInputs, labels: Array, chosen: Chosen, ballot: Ballot
    ) -> DisparityEvidence:
        value, sight = laid = laid_out(labels, chosen, ballot)
        signs = plane_signs(labels, chosen, ballot, laid, inputs.evidence.reliability)
        speaks = (sight > 0) & np.isfinite(inputs.left)
        return DisparityEvidence.of(value, SIGMA, speaks * plane_trust(signs, self.params.trained_on))

    @staticmethod
    def _tell(ctx: Context, chosen: Chosen, labels: Array) -> None:
        accepted = np.isfinite(chosen.planes[:, 0])
        ctx.measure("regions", len(accepted))
        ctx.measure("planes", int(accepted.sum()))
        ctx.assumed("smoothness", np.concatenate([[True], accepted]), labels + np.int32(1))


def _labels(regions: Array | None, levels: Array, scale: int) -> Array:
    """int32 (H, W) from 0, every pixel of some region."""
    if regions is None:
        return superpixels_in(levels, SuperpixelsParams(), scale)
    return numbered(complete(np.maximum(regions, 0)))[0]


def _ballot(inputs: RegionPlanesInputs) -> Ballot:
    value, trust = inputs.evidence.value, inputs.evidence.reliability
    voting = trust >= BELIEVED if inputs.consistent is None else inputs.consistent & (trust > 0)
    votes = np.where(voting, trust**2, 0).astype(np.float32)
    right = inputs.right_disparity
    return Ballot(value, votes, np.full_like(value, np.nan) if right is None else right)
