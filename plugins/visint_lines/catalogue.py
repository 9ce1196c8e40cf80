"""The junction catalogue: which labels the lines at a junction may carry together.

Huffman's and Clowes' polyhedral junctions with Malik's curved ones (Malik 1987, DOI 10.1007/BF00128527), read
from ``catalogue.yaml``; the tests derive it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import pairwise
from math import tau
from types import MappingProxyType

__all__ = ["DEGREES", "FLIP", "KINDS", "LABELS", "Row", "catalogue", "legal", "slots"]

Row = tuple[str, ...]
LABELS = ("+", "-", ">", "<", ">>", "<<", "x")
"""Every label of a line as one walks along it; ``x`` is a mark, a shadow or a change of albedo."""
FLIP: Mapping[str, str] = MappingProxyType(
    {"+": "+", "-": "-", ">": "<", "<": ">", ">>": "<<", "<<": ">>", "x": "x"}
)
"""The same line walked the other way."""
KINDS: Mapping[str, str] = MappingProxyType(
    {
        "+": "convex",
        "-": "concave",
        ">": "occluding",
        "<": "occluding",
        ">>": "limb",
        "<<": "limb",
        "x": "mark",
    }
)
"""The kind of line, without its direction."""
DEGREES: Mapping[int, Row] = MappingProxyType({1: ("E",), 2: ("L", "C", "P"), 3: ("Y", "W", "T", "R")})
"""The types of junction by the number of lines that meet; four and more are not constrained."""


@cache
def catalogue() -> Mapping[str, tuple[Row, ...]]:
    """Rows by type of junction: L, Y, W (arrow), T, C (curvature-L), R (three-tangent), E, P."""
    from ruamel.yaml import YAML

    from visint.io import resource_text

    read = YAML(typ="safe", pure=True).load(resource_text(__package__, "catalogue.yaml"))
    return MappingProxyType({str(kind): tuple(tuple(row) for row in rows) for kind, rows in read.items()})


@cache
def legal(kind: str) -> frozenset[Row]:
    """The rows of a type, for a lookup; of ``M``, four lines and more, there are none."""
    rows = catalogue().get(kind, ())
    if kind == "Y":
        rows = tuple(row[i:] + row[:i] for row in rows for i in range(3))
    return frozenset(rows)


def slots(kind: str, angles: Sequence[float]) -> tuple[int, ...]:
    """Which line fills which slot of a type's rows.

    Parameters
    ----------
    kind
        The type of junction.
    angles
        Directions of the lines away from the junction, radians, counter-clockwise as seen (y up), ascending.
    """
    count = len(angles)
    if count < 2:
        return tuple(range(count))
    gaps = _gaps(angles)
    behind = gaps.index(max(gaps)) + 1  # the widest gap: barbs and bars, and L's first slot
    first = gaps.index(min(gaps)) + 2 if kind == "R" else behind
    return tuple((first + i) % count for i in range(count))


def _gaps(angles: Sequence[float]) -> list[float]:
    """The angle from each line to the next, counter-clockwise."""
    return [after - before for before, after in pairwise([*angles, angles[0] + tau])]
