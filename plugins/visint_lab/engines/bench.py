"""``visint bench engine`` and ``visint bench start``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from visint_lab.engines.contest import PEERS, Heat, heats
from visint_lab.engines.starts import starts
from visint_lab.engines.stopwatch import Asked
from visint_lab.engines.telling import head, notes, rows
from visint_lab.trials.grid import aligned, as_csv, number

__all__ = ["engines", "start"]


def engines(peer: Sequence[str] | None, out: Path | None, asked: Asked | None = None) -> None:
    """Prints the contest of engines, and writes ``engines.csv`` into ``out`` if given."""
    asked = asked or Asked()
    found: list[Heat] = []
    for heat in heats(asked, _peers(peer)):
        print(f"{heat.engine}: {heat.failure or 'done'}", file=sys.stderr)
        found.append(heat)
    columns, table = head(asked.chains), rows(found, asked.chains)
    print(aligned(columns, table) + "\n\n" + "\n".join(notes(found, asked.chains, asked.size)))
    if out is not None:
        from visint.io import make_folder, write_text

        make_folder(out)
        write_text(out / "engines.csv", as_csv(columns, table))


def _peers(asked: Sequence[str] | None) -> tuple[str, ...]:
    if asked is None or list(asked) == ["all"]:
        return PEERS
    return () if list(asked) == ["none"] else tuple(asked)


def start() -> None:
    """Prints how long it takes to begin."""
    found = starts()
    table = [[name, number(spread.median, 0), number(spread.least, 0)] for name, spread in found.items()]
    print(aligned(["milliseconds", "median", "least"], table))
