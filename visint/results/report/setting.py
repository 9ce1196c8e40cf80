"""What every section of the report is made from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from visint.results.report.maps import Map, figure, is_map
from visint.results.report.markup import Markup

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["Setting"]


class Setting(NamedTuple):
    """The result to report on, and the longest side of its pictures in pixels."""

    result: Result
    side: int

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

    def small(self) -> Setting:
        """The same for pictures in a row of several."""
        return self._replace(side=min(self.side, 480))

    def maps(self) -> dict[str, Any]:
        """The outputs that are pictures, by name."""
        return {name: value for name, value in self.result.outputs.items() if is_map(value)}
