"""A bound graph put in order: what runs after what, where each value lies, and when it is let go."""

from visint.schedule.compile import compile_graph
from visint.schedule.steps import Block, Cell, Fit, Pyramid, Repeat, Schedule, Step

__all__ = ["Block", "Cell", "Fit", "Pyramid", "Repeat", "Schedule", "Step", "compile_graph"]
