"""Prior probabilities of labels from features: Tables 4.3 and 4.4 as corrected."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, exp, hypot, inf, pi, radians, tau

import numpy as np

from visint.arrays import Array
from visint_lines.catalogue import LABELS
from visint_lines.diagram import Diagram, Junction, Measures

__all__ = ["Thresholds", "arc_prior", "type_prior"]

FLAT = {"+": 0.25, "-": 0.15, ">": 0.2, "<": 0.2, ">>": 0.05, "<<": 0.05, "x": 0.1}
"""What is believed of an arc of which depth says nothing."""
FAINTEST = np.array([1e-4 if label != "x" else 1e-6 for label in LABELS])
"""What is left of labels that features exclude: lines that are hard to measure are seldom marks."""
UNMARKED = 0.3
"""Of a mark where depth is known but not here: that is a face too narrow, which no mark leaves."""
FAR = 1e4
"""A gap, in pixels, that stands for one to where nothing is known."""
BLUNTEST = radians(174)
"""The angle from which on two lines that meet in a corner are one: corners have been told from bends before."""
BENT_C = 0.4
"""How well a curvature-L may pass for bent: below the window of the corners it looks like one."""
TOUCH = 0.1
"""How likely a limb leaves a three-tangent junction in a direction that shows no tangency."""
FLOOR = 0.02
"""No type of junction is impossible: features are measured."""
NARROW = 0.2
"""How far they are believed where a side is too narrow to have depth that is not its neighbour's as well."""
LEAST_SEEN = 0.3
"""Share of an arc's points with depth on both sides from which on its features are fully believed."""


@dataclass(frozen=True)
class Thresholds:
    """Where the sigmoids of Table 4.3 stand: ``gap`` in pixels, ``dihedral`` in degrees, and their slopes."""

    gap: float = 4.0
    dihedral: float = 9.0
    slope_gap: float = 0.7
    slope_dihedral: float = 0.5


def sigmoid(x: float, slope: float, at: float, spread: float = 0.0) -> float:
    """1/(1 + exp(−slope (x − at))); averaged over an error of x of standard deviation ``spread``.

    A sigmoid averaged over a Gaussian is about one with a slope of slope/√(1 + π slope² spread²/8).
    """
    if spread == inf:
        return 0.5
    softer = slope / hypot(1.0, slope * spread * (pi / 8) ** 0.5)
    return 1.0 / (1.0 + exp(-min(max(softer * (x - at), -500.0), 500.0)))


def arc_prior(measures: Measures | None, background: str, floating: float, at: Thresholds) -> Array:
    """(7,) probabilities of :data:`LABELS`, walking from start to end.

    Table 4.3 with angles in degrees, creases gated by the gap, and the direction of what occludes from the
    gap's sign: the nearer side is the surface's.

    Parameters
    ----------
    background
        The side, if any, on which the background lies.
    floating
        How surely the object is in front of the background there (Trytten's preference); 0.5 is no preference.
    """
    told = np.array([FLAT[label] for label in LABELS])
    if measures is not None:
        least = NARROW if measures.spread < inf else 0.0
        trust = max(least, min(1.0, (1.0 if abs(measures.gap) == inf else measures.seen) / LEAST_SEEN))
        told[LABELS.index("x")] *= UNMARKED
        told = trust * _from_depth(measures, at) + (1 - trust) * told / told.sum()
    if background:
        inside = (">", ">>") if background == "left" else ("<", "<<")
        told = told * np.array([floating if label in inside else 1 - floating for label in LABELS])
    return np.asarray(told / told.sum())


def _from_depth(m: Measures, at: Thresholds) -> Array:
    gap = min(max(m.gap, -FAR), FAR)
    jump = sigmoid(abs(gap), at.slope_gap, at.gap + m.spread, m.spread) if m.spread < inf else 0.5
    left = sigmoid(gap, at.slope_gap, 0.0, m.spread)
    angle, spread = degrees(m.dihedral), degrees(m.spread_dihedral) if m.spread_dihedral < inf else inf
    limb_left, limb_right = (sigmoid(side, 12.0, 0.35) for side in (m.left, m.right))
    said = {
        "+": sigmoid(angle, at.slope_dihedral, at.dihedral, spread) * (1 - jump),
        "-": sigmoid(-angle, at.slope_dihedral, at.dihedral, spread) * (1 - jump),
        ">": jump * (1 - left) * (1 - limb_right),
        "<": jump * left * (1 - limb_left),
        ">>": jump * (1 - left) * limb_right,
        "<<": jump * left * limb_left,
    }
    occludes, limb = said[">"] + said["<"], said[">>"] + said["<<"]
    said["x"] = 1 - max(said["+"], said["-"], occludes, limb)
    told = np.array([said[label] for label in LABELS]) + FAINTEST
    return np.asarray(told / told.sum())


def type_prior(diagram: Diagram, junction: Junction) -> dict[str, float]:
    """Probabilities of the types of a junction: Table 4.4 as corrected; empty where nothing is constrained.

    A junction at the frame is where a line leaves the image, not the scene.
    """
    arcs = [diagram.arcs[spoke.arc] for spoke in junction.spokes]
    limb = [arc.measures.limbness if arc.measures else 0.5 for arc in arcs]
    gaps = [
        (b - a) % tau
        for a, b in zip(junction.angles, (*junction.angles[1:], *junction.angles[:1]), strict=True)
    ]
    if junction.frame or len(arcs) not in (1, 2, 3):
        return {}
    if len(arcs) == 1:
        return {"E": 1.0}
    told = (
        _of_two(min(gaps), limb, junction.smooth)
        if len(arcs) == 2
        else _of_three(max(gaps), min(gaps), max(limb))
    )
    total = sum(told.values()) + FLOOR * len(told)
    return {kind: (share + FLOOR) / total for kind, share in told.items()}


def _of_two(angle: float, limb: list[float], smooth: bool) -> dict[str, float]:
    straight = max(sigmoid(angle, 25.0, BLUNTEST), 1 - FLOOR if smooth else 0.0)
    change = max(limb) - min(limb)
    return {
        "P": straight * (1 - change),
        "L": (1 - straight) * (1 - max(limb)),
        "C": max(straight, BENT_C) * change,
    }


def _of_three(widest: float, narrowest: float, limb: float) -> dict[str, float]:
    arrow = sigmoid(widest - pi, 20.0, radians(13))
    fork = sigmoid(pi - widest, 20.0, radians(13))
    tangent = 1 - arrow if widest > pi else 1 - fork
    touching = limb * max(sigmoid(-narrowest, 12.0, -radians(35)), TOUCH)
    return {
        "W": arrow * (1 - touching),
        "Y": fork * (1 - limb),
        "T": tangent * (1 - touching),
        "R": max(tangent, touching) * touching,
    }
