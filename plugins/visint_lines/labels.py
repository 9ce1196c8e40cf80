"""A labelled line diagram."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from visint.arrays import Array
from visint_lines.catalogue import LABELS
from visint_lines.diagram import Diagram

__all__ = ["ArcLabel", "JunctionLabel", "Labels"]


class ArcLabel(NamedTuple):
    """An arc's label walking from its start to its end, and the probability of each of the seven."""

    label: str
    probabilities: tuple[float, ...]

    @property
    def probability(self) -> float:
        """Of the label itself."""
        return self.probabilities[LABELS.index(self.label)]


class JunctionLabel(NamedTuple):
    """A junction's type: L, C, P, Y, W (arrow), T, R, E, M (four lines and more) or ``frame``.

    ``legal`` says that its arcs' labels are a row of the type; ``probabilities``: of every type it might be.
    """

    type: str
    legal: bool
    probabilities: dict[str, float]


@dataclass(frozen=True, eq=False)
class Labels:
    """A line diagram with a label for each arc and a type for each junction.

    ``picture``: uint8 (H, W), the image to draw it over, or None. ``exact``: it is the likeliest of all
    labellings, not only of those that were looked at.
    """

    __kind__: ClassVar[str] = "lines.Labels"

    diagram: Diagram
    arcs: tuple[ArcLabel, ...] = ()
    junctions: tuple[JunctionLabel, ...] = ()
    method: str = "exact"
    exact: bool = True
    picture: Array | None = None

    def scaled(self, factor: float, size: tuple[int, int]) -> Labels:
        """The labels on a finer or coarser raster; the picture is left behind."""
        return Labels(
            self.diagram.scaled(factor, size), self.arcs, self.junctions, self.method, self.exact, None
        )
