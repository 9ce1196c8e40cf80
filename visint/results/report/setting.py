"""What every section of the report is made from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from visint.results import pictures
from visint.results.report.maps import Map, figure, is_map, over
from visint.results.report.markup import Markup

if TYPE_CHECKING:
    from visint.results.against import Against
    from visint.results.result import Result

__all__ = ["REFERENCE", "Setting"]

REFERENCE = "reference-view"
"""The id of the picture of the reference view: the script lays it beneath maps and over the surface."""


class Setting(NamedTuple):
    """What to report on.

    Attributes
    ----------
    result
        The run.
    side
        The longest side of its pictures in pixels.
    against
        Another run to compare it with.
    drawings
        File name → the bytes of an SVG that a writer made of an output.
    """

    result: Result
    side: int
    against: Against | None = None
    drawings: Mapping[str, bytes] = {}

    def unit(self, kind: str) -> str:
        """The unit of a field kind; that of the baseline by its name."""
        known = self.result.graph.catalog.kind(kind)
        unit = known.array.unit if known and known.array else "1"
        if not unit.startswith("baseline"):
            return unit
        camera = self.result.camera
        return unit.replace("baseline", camera.unit if camera else "relative")

    def figure(self, title: str, kind: str, value: Any, unit: str | None = None) -> Markup:
        """A map as a figure; its unit is that of its kind if not given."""
        shown = Map(title, kind, value, self.unit(kind) if unit is None else unit)
        return figure(shown, self.side)

    def over_view(self, title: str, kind: str, value: Any) -> Markup:
        """A map as a figure that can be laid over the reference view, if it is as large as that."""
        found = pictures.reference(self.result)
        if found is None or found[1].shape[:2] != value.shape[:2]:
            return self.figure(title, kind, value)
        return over(Map(title, kind, value, self.unit(kind)), self.side)

    def view(self, title: str, kind: str, value: Any) -> Markup:
        """The figure of the reference view itself."""
        return figure(Map(title, kind, value), self.side, REFERENCE)

    def small(self) -> Setting:
        """The same for pictures in a row of several."""
        return self._replace(side=min(self.side, 480))

    def maps(self) -> dict[str, Any]:
        """The outputs that are pictures, by name."""
        return {name: value for name, value in self.result.outputs.items() if is_map(value)}
