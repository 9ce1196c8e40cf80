"""Small tables of text: aligned for the terminal, and as CSV."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping, Sequence
from io import StringIO

__all__ = ["aligned", "as_csv", "as_json", "number"]

Cells = Sequence[Sequence[str]]


def number(value: float | None, digits: int = 1) -> str:
    """A figure, or a dash where there is none."""
    return "–" if value is None or math.isnan(value) else f"{value:.{digits}f}"


def aligned(head: Sequence[str], rows: Cells) -> str:
    """Columns side by side, the first to the left, the others to the right, under a rule."""
    table = [list(head), *map(list, rows)]
    widths = [max(len(row[column]) for row in table) for column in range(len(head))]
    lines = ["  ".join(_padded(row, widths)).rstrip() for row in table]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def _padded(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    first, *others = zip(row, widths, strict=True)
    return [first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)]


def as_json(parts: Mapping[str, tuple[Sequence[str], Cells]], notes: Sequence[str] = ()) -> str:
    """The same for programs: a list of rows a table, each by the columns' names; what is a number is one."""
    tables = {
        name: [{key or "name": _value(cell) for key, cell in zip(head, row, strict=True)} for row in rows]
        for name, (head, rows) in parts.items()
    }
    return json.dumps({**tables, "notes": list(notes)}, indent=1, ensure_ascii=False)


def _value(cell: str) -> str | float | None:
    """A cell as JSON has it; a dash is null."""
    if cell == "–":
        return None
    try:
        found = float(cell)
    except ValueError:
        return cell
    return found if math.isfinite(found) else cell


def as_csv(head: Sequence[str], rows: Cells) -> str:
    """The same for spreadsheets, RFC 4180."""
    out = StringIO()
    writer = csv.writer(out)
    writer.writerow(head)
    writer.writerows(rows)
    return out.getvalue()
