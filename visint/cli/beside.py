"""What a run leaves beside its folder, where asked to: a timeline of calls, a recording of maps."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visint.events import Observer
    from visint.graph import Graph

__all__ = ["Beside"]


class Beside:
    """The files of ``--trace`` and ``--rerun``: who watches the run for them, and writing them after it.

    Raises
    ------
    UsageError
        VI701 if a recording is asked for and the extra is missing: before the work, not after it.
    """

    def __init__(self, graph: Graph, trace: str, rerun: str) -> None:
        from visint.engine.profile import Profile
        from visint.results.recording import Recording

        self._trace, self._rerun = trace, rerun
        self._profile = Profile() if trace else None
        self._recording = Recording(graph) if rerun else None

    @property
    def observers(self) -> tuple[Observer, ...]:
        """Who is to watch the run."""
        return tuple(one for one in (self._profile, self._recording) if one is not None)

    def write(self) -> None:
        """Writes what was asked for.

        Raises
        ------
        OutputError
            VI601 if a file cannot be written.
        """
        from visint import io

        if self._profile is not None:
            io.write_text(self._trace, json.dumps(self._profile.chrome()))
        if self._recording is not None:
            io.write_bytes(self._rerun, self._recording.data())
