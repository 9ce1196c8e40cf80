"""Toy modules that show what the engine told them, or speak up through the context."""

from __future__ import annotations

import time

from visint.module import Context, Module, Params, Ports
from visint.testing.toys.scalars import MaybeValue, Nothing, Value

__all__ = ["Level", "Measure", "Noise", "Sleep", "Turn", "Warn"]


class Turn(Module[Params, Nothing, Value]):
    """The turn of the innermost loop, from 0."""

    name = "turn"
    per_turn = True

    def run(self, inputs: Nothing, ctx: Context) -> Value:
        """``ctx.turn``."""
        return Value(value=ctx.turn)


class LevelOutputs(Ports):
    """Where the node runs: its level, and the images' size there (0 × 0 without images)."""

    level: float
    rows: float
    columns: float


class Level(Module[Params, Nothing, LevelOutputs]):
    """The level of the pyramid and the size of the images there."""

    name = "level"

    def run(self, inputs: Nothing, ctx: Context) -> LevelOutputs:
        """``ctx.level`` and ``ctx.size``."""
        rows, columns = ctx.size or (0, 0)
        return LevelOutputs(level=ctx.level, rows=rows, columns=columns)


class NoiseParams(Params):
    """``sigma``: one standard deviation."""

    sigma: float = 1.0


class Noise(Module[NoiseParams, MaybeValue, Value]):
    """Normal noise added to a number (0 if there is none): equal seeds give equal numbers."""

    name = "noise"
    per_turn = True

    def run(self, inputs: MaybeValue, ctx: Context) -> Value:
        """``value + N(0, sigma²)``."""
        return Value(value=(inputs.value or 0.0) + ctx.rng.normal(0.0, self.params.sigma))


class SleepParams(Params):
    """``seconds``: how long it takes."""

    seconds: float = 0.01


class Sleep(Module[SleepParams, MaybeValue, Value]):
    """Takes its time, and asks every 5 ms whether the run was interrupted; the number passes through."""

    name = "sleep"

    def run(self, inputs: MaybeValue, ctx: Context) -> Value:
        """The input (0 if there is none), ``params.seconds`` later."""
        end = time.monotonic() + self.params.seconds
        ctx.check()
        while (left := end - time.monotonic()) > 0:
            time.sleep(min(left, 0.005))
            ctx.check()
        return Value(value=inputs.value or 0.0)


class Warn(Module[Params, Value, Value]):
    """Says something; the number passes through."""

    name = "warn"

    def run(self, inputs: Value, ctx: Context) -> Value:
        """The input; warns ``toy_warning``."""
        ctx.warn("toy_warning", "this is only a toy")
        return Value(value=inputs.value)


class Measure(Module[Params, Value, Value]):
    """Records the number it lets through under the name ``seen``."""

    name = "measure"

    def run(self, inputs: Value, ctx: Context) -> Value:
        """The input; measures ``seen``."""
        ctx.measure("seen", inputs.value)
        return Value(value=inputs.value)
