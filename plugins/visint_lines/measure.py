"""``lines.features``: what depth says of each arc, arcs cut where a limb begins or ends."""

from __future__ import annotations

from dataclasses import replace
from math import radians
from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence, Depth, Regions, read_only
from visint.fields import Camera
from visint.module import Context, Module, Params, Ports
from visint_lines.diagram import Diagram, Measures
from visint_lines.faces import flat_faces
from visint_lines.limbness import LimbPoints, limb_points
from visint_lines.profile import Profile, profile
from visint_lines.sections import Sections, Surfaces, cut, surfaces
from visint_lines.splitting import split

__all__ = ["Features", "FeaturesParams"]

UNTOLD = 0.3
"""Limbness of a side too narrow to tell."""
OFF = 0.6
"""Pixels by which a line lies off its place: on a steep face that makes a gap."""


HIDES = 2.0
"""Pixels of depth by which a limb is nearer than what it hides."""


SHOWN = 0.1
"""Share of the points that look like limbs of what is behind, up to which surfaces count as opaque."""


class FeaturesParams(Params):
    """Parameters of ``lines.features``.

    Parameters
    ----------
    across
        Samples to either side of a line from which depth is extrapolated to it. More averages more noise out
        and believes longer that faces are parabolas.
    blur
        Full-size pixels to either side of a line within which depth is not to be believed, because it was
        smoothed across, or matched where one view sees nothing. 0 suits range images, 5 stereo. More sees less
        of small faces.
    window
        Pixels of the level to each side of the square in which a plane is fitted for a normal.
    samples
        Normals in a row away from the line that limbness is told from. More is surer, and needs wider surfaces.
    size
        Size of the rank test: the share of trendless points that pass it.
    start
        Least starting angle, radians, of a limb. More refuses rounded edges, and limbs in coarse depth.
    """

    across: int = Field(default=8, ge=3, le=64)
    blur: float = Field(default=0.0, ge=0, le=64)
    window: int = Field(default=2, ge=1, le=16)
    samples: int = Field(default=10, ge=6, le=64)
    size: float = Field(default=0.01, gt=0, lt=0.5)
    start: float = Field(default=radians(68), ge=0)


class FeaturesInputs(Ports):
    """A diagram, the regions it was parsed from (as ``lines.parse`` gives them) and depth.

    Without a camera depth counts as that of an uncalibrated one: angles are right up to a stretch.
    """

    diagram: Diagram
    regions: Regions[Array, "H W"]
    depth: Depth[Array, "H W"]
    camera: Camera | None = None


class FeaturesOutputs(Ports):
    """The diagram with Table 4.2's features in its arcs, cut at ends of limbs; limbness along its lines."""

    diagram: Diagram
    limbness: Confidence[Array, "H W"]


class Features(Module[FeaturesParams, FeaturesInputs, FeaturesOutputs]):
    """Depth gap, dihedral angle and limbness of each arc, from depth on both sides extrapolated to it.

    Table 4.2 with the gap extrapolated: each side is a parabola of its own in 1/Z with one bend for both, so
    that a slanted face has no gap at its crease and a mark on a ball no angle. Limbness is section 4.1.3's: the
    share of points where angles to the line of sight fall, by Spearman's test, and start steep. Where that
    changes along an arc, a limb begins or ends, and there the arc is cut.

    Assumes surfaces that are smooth within their regions. Where depth is known on one side alone, that side
    counts as the nearer one.
    """

    name = "features"
    assumptions: ClassVar[tuple[str, ...]] = ("smoothness", "opacity")

    def run(self, inputs: FeaturesInputs, ctx: Context) -> FeaturesOutputs:
        """The measured diagram."""
        p = self.params
        camera = inputs.camera or Camera.uncalibrated(inputs.regions.shape[1], inputs.regions.shape[0])
        seen = surfaces(inputs.depth, inputs.regions, camera, p.window)
        ctx.check()
        blur = p.blur / ctx.scale
        sections = cut(inputs.diagram, seen, _offsets(max(p.across, p.samples), blur))
        ctx.check()
        found = _observed(sections, p, blur, _flat(inputs.diagram, sections.arc, seen))
        ctx.assumed("opacity", found.hides)
        diagram, owner = split(inputs.diagram, sections.arc, sections.point, found.points, blur)
        diagram = replace(
            diagram,
            arcs=tuple(
                replace(arc, measures=_summed(found, owner == number))
                for number, arc in enumerate(diagram.arcs)
            ),
        )
        return FeaturesOutputs(diagram=diagram, limbness=_painted(diagram))


def _offsets(count: int, blur: float) -> Array:
    """Distances of the samples: every pixel; beyond the blur in steps that keep up with it."""
    near = np.arange(1, int(blur) + 1)
    return np.concatenate([near, blur + np.arange(1, count + 1) * (1 + blur / 12)])


class _Observed(NamedTuple):
    """Section by section: the profile; whether either side (N, 2) is a limb's and can tell; the line itself;
    whether both sides reach beyond the blur. And whether limbs hide what lies behind them.
    """

    profile: Profile
    limb: Array
    told: Array
    points: LimbPoints
    wide: Array
    off: float
    hides: bool


def _flat(diagram: Diagram, arc: Array, seen: Surfaces) -> Array:
    """bool (N, 2): whether the region on either side of each section is flat."""
    sides = np.array([(a.left, a.right) for a in diagram.arcs], dtype=np.int64).reshape(-1, 2)
    return np.asarray(flat_faces(seen)[sides[arc]])


def _observed(sections: Sections, p: FeaturesParams, blur: float, flat: Array) -> _Observed:
    near, off = int(blur), OFF * (1 + blur / 4)
    slant = sections.of(p.samples, near).slant
    limb, asked, edge = limb_points(slant, sections.offset, p.size, p.start, sharp=blur == 0)
    faces = sections.of(p.across, near)
    told = profile(faces.depth, sections.offset, faces.there)
    least = HIDES + off * told.steepness
    nearer_by = np.stack([told.gap, -told.gap], axis=-1)
    shown = limb & told.seen[:, None] & (nearer_by < -least[:, None])
    hides = float(shown.sum()) <= SHOWN * max(1.0, float(limb.sum()))
    limb &= ~(told.seen[:, None] & (nearer_by < least[:, None]))  # a limb hides what is behind it
    limb &= ~flat
    wide = sections.wide(near)
    asked = (asked | flat) & wide
    limb &= asked
    line = _of_line(LimbPoints(limb, asked, edge), told)
    return _Observed(told, limb, asked, line, np.asarray(wide.all(axis=1)), off, hides)


def _of_line(sides: LimbPoints, told: Profile) -> LimbPoints:
    """The same of the lines, from what is said of their two sides: the limb counts, or else the nearer side."""
    which = np.where(sides.passed.any(axis=1), sides.passed[:, 1], told.gap < 0).astype(np.int64)
    rows = np.arange(len(which))
    asked = np.where(told.seen, sides.asked[rows, (told.gap < 0).astype(np.int64)], sides.asked.any(axis=1))
    return LimbPoints(np.asarray(sides.passed.any(axis=1)), np.asarray(asked), sides.edge[rows, which])


def _summed(found: _Observed, mine: Array) -> Measures:
    """The features of one arc from its sections: medians, and how sure they are."""
    told, count = found.profile, int(mine.sum())
    if count == 0:
        return Measures()
    left, right = (
        float(passed / asked) if asked else UNTOLD
        for passed, asked in zip(found.limb[mine].sum(axis=0), found.told[mine].sum(axis=0), strict=True)
    )
    both = mine & told.seen
    seen = float((both & found.wide).sum() / count)
    if both.sum() >= max(2, 0.3 * count):
        gap, spread = _middle(told.gap[both])
        spread = float(np.hypot(spread, found.off * np.median(told.steepness[both])))
        bend, spread_bend = _middle(told.dihedral[both])
        return Measures(gap, spread, bend, spread_bend, left, right, seen)
    one = told.alone[mine]
    if np.count_nonzero(one) >= 0.5 * count and one.sum():  # behind it nothing is known
        return Measures(float(np.sign(one.sum())) * np.inf, 1.0, 0.0, np.inf, left, right, seen)
    return Measures(left=left, right=right, seen=seen)


def _middle(value: Array) -> tuple[float, float]:
    """(median, its standard error); neighbouring sections share pixels, so half of them count."""
    middle = float(np.median(value))
    spread = 1.4826 * float(np.median(np.abs(value - middle)))
    return middle, 1.25 * spread / max(1.0, len(value) / 2) ** 0.5


def _painted(diagram: Diagram) -> Array:
    """float32 (H, W): the limbness of the arc through each pixel, 0 elsewhere."""
    from visint_lines.painting import along

    limbness = np.array([arc.measures.limbness if arc.measures else 0.0 for arc in diagram.arcs])
    return read_only(along(diagram, limbness).astype(np.float32))
