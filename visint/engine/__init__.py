"""The engine: one loop over a schedule that runs every graph, with or without feedback, levels and a hub."""

from visint.engine.options import Options
from visint.engine.run import run

__all__ = ["Options", "run"]
