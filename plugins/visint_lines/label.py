"""``lines.label``: what each line is in the scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from visint.arrays import Array, Boundaries, BoundaryKinds, Image, read_only
from visint.fields import BoundaryKind
from visint.module import Context, Module, Params, Ports
from visint_lines.catalogue import KINDS, LABELS
from visint_lines.diagram import Diagram
from visint_lines.elimination import solve
from visint_lines.factors import NEVER, best_type, factors_of
from visint_lines.labels import ArcLabel, JunctionLabel, Labels
from visint_lines.painting import along
from visint_lines.priors import Thresholds, arc_prior, type_prior
from visint_lines.relaxation import UNDIRECTED, published, rows

__all__ = ["Label", "LabelParams", "labelled"]

NUMBERS = {
    "limb": BoundaryKind.LIMB,
    "occluding": BoundaryKind.OCCLUDING,
    "convex": BoundaryKind.CONVEX,
    "concave": BoundaryKind.CONCAVE,
    "mark": BoundaryKind.MARK,
}


class LabelParams(Params):
    """Parameters of ``lines.label``.

    Parameters
    ----------
    method
        ``exact``: the likeliest of all labellings, junction types soft. ``rows``: relaxation with rows of the
        catalogue. ``published``: the dissertation's two epochs over types of junctions.
    gap
        Pixels of the level from which on a gap of depth is one. More takes shallow steps for creases.
    dihedral
        Degrees from which on a bend is a crease. More takes flat creases for marks.
    floating
        How surely objects are in front of the background that surrounds them; 0.5 has no preference.
    illegal
        Weight of a junction whose labels no row of the catalogue allows, beside 1. 0 forbids it: then one
        misread junction may leave no labelling at all.
    """

    method: Literal["exact", "rows", "published"] = "exact"
    gap: float = Field(default=4.0, gt=0)
    dihedral: float = Field(default=9.0, gt=0)
    floating: float = Field(default=0.9, gt=0, lt=1)
    illegal: float = Field(default=0.02, ge=0, le=1)


class LabelInputs(Ports):
    """A diagram, with features if depth is known, and the image that the labels are drawn over."""

    diagram: Diagram
    image: Image[Array, "H W"] | None = None


class LabelOutputs(Ports):
    """The labels, and the same as maps: the kind of every boundary, limbs, creases, and all depth edges."""

    labels: Labels
    kinds: BoundaryKinds[Array, "H W"]
    limbs: Boundaries[Array, "H W"]
    creases: Boundaries[Array, "H W"]
    outlines: Boundaries[Array, "H W"]


class Label(Module[LabelParams, LabelInputs, LabelOutputs]):
    """Labels every line as convex or concave crease, occluding edge, limb or mark, and every junction by type.

    Priors of arcs are Table 4.3's and of junctions Table 4.4's, as corrected; what lines may meet is the
    catalogue's (Malik 1987, DOI 10.1007/BF00128527). The exact search is over directed labels with soft types:
    one misread junction then costs one row, not the drawing. Which side occludes follows from the gap's sign,
    and next to the background from the floating preference (Trytten).

    Assumes opaque, piecewise smooth bodies with trihedral corners seen from a general viewpoint; four lines and
    more at a point are not constrained.
    """

    name = "label"
    assumptions: ClassVar[tuple[str, ...]] = ("general_viewpoint", "opacity", "trihedral_corners")

    def run(self, inputs: LabelInputs, ctx: Context) -> LabelOutputs:
        """The labelled diagram."""
        labels = labelled(inputs.diagram, self.params, inputs.image)
        ctx.check()
        met = [one for one in labels.junctions if one.type != "frame"]
        ctx.assumed("trihedral_corners", all(one.type != "M" for one in met))
        ctx.assumed("general_viewpoint", all(one.legal for one in met))
        ctx.measure("legal_junctions", sum(one.legal for one in met) / max(1, len(met)))
        return LabelOutputs(labels=labels, **_maps(labels))


def labelled(diagram: Diagram, params: LabelParams, image: Array | None = None) -> Labels:
    """The labels of a diagram whose arcs may have been measured."""
    at = Thresholds(gap=params.gap, dihedral=params.dihedral)
    arcs = np.array([arc_prior(a.measures, a.background, params.floating, at) for a in diagram.arcs])
    arcs = arcs.reshape(-1, len(LABELS))
    types = [type_prior(diagram, junction) for junction in diagram.junctions]
    told, exact = _SOLVERS[params.method](diagram, arcs, types, params)
    chosen = [LABELS[i] for i in told[0]]
    junctions = tuple(
        JunctionLabel(*best_type(junction, chosen, prior, max(params.illegal, 1e-6)))
        for junction, prior in zip(diagram.junctions, types, strict=True)
    )
    own = tuple(ArcLabel(label, tuple(map(float, p))) for label, p in zip(chosen, told[1], strict=True))
    return Labels(diagram, own, junctions, params.method, exact, _grey(image))


Told = tuple[tuple[Array, Array], bool]


def _exact(diagram: Diagram, arcs: Array, types: Sequence[dict[str, float]], params: LabelParams) -> Told:
    answer = solve(np.log(np.maximum(arcs, np.exp(NEVER))), factors_of(diagram, types, params.illegal))
    return (answer.best, answer.marginals), answer.exact


def _rows(diagram: Diagram, arcs: Array, types: Sequence[dict[str, float]], params: LabelParams) -> Told:
    del params
    told = rows(diagram, arcs, types).arcs
    return (told.argmax(axis=1), told), False


def _published(diagram: Diagram, arcs: Array, types: Sequence[dict[str, float]], params: LabelParams) -> Told:
    """Undirected labels relaxed; each then has the direction that its prior prefers."""
    del params
    kind = np.array([UNDIRECTED.index(KINDS[label]) for label in LABELS])
    joined = np.stack([arcs[:, kind == k].sum(axis=1) for k in range(len(UNDIRECTED))], axis=-1)
    told = published(diagram, joined, types).arcs
    directed = arcs * told[:, kind] / np.maximum(joined[:, kind], 1e-12)
    chosen = np.where(kind == told.argmax(axis=1)[:, None], directed, -1.0).argmax(axis=1)
    return (chosen, directed / np.maximum(directed.sum(axis=1, keepdims=True), 1e-12)), False


_SOLVERS = {"exact": _exact, "rows": _rows, "published": _published}


def _grey(image: Array | None) -> Array | None:
    from visint.io import srgb_from_linear

    return None if image is None else read_only(srgb_from_linear(image))


def _maps(labels: Labels) -> dict[str, Array]:
    """Kinds as a map, the most significant winning a pixel, and the sets that cues ask for."""
    rank = np.array([6 - NUMBERS[KINDS[arc.label]] for arc in labels.arcs], dtype=np.int64)
    painted = along(labels.diagram, rank)
    kinds = np.where(painted > 0, 6 - painted, 0).astype(np.uint8)
    limb, crease = kinds == BoundaryKind.LIMB, (kinds == BoundaryKind.CONVEX) | (kinds == BoundaryKind.CONCAVE)
    outlines = limb | (kinds == BoundaryKind.OCCLUDING)
    return {"kinds": kinds, "limbs": limb, "creases": crease, "outlines": outlines}
