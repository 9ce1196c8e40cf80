"""Toy modules on single numbers: enough for every law of scheduling."""

from __future__ import annotations

from visint.module import Context, Module, Params, Ports

__all__ = ["Add", "Constant", "Counter", "Delay", "Diverge", "React", "Scale", "Threshold", "Value"]


class Value(Ports):
    """One number."""

    value: float


class Nothing(Ports):
    """No port."""


class MaybeValue(Ports):
    """One number, or none yet (a feedback edge with ``start: none``)."""

    value: float | None = None


class AddInputs(Ports):
    """Two numbers; what is missing counts as 0."""

    a: float | None = None
    b: float | None = None


class AddOutputs(Ports):
    """Their sum."""

    sum: float


class Add(Module[Params, AddInputs, AddOutputs]):
    """The sum of two numbers: Fibonacci by two feedback edges."""

    name = "add"

    def run(self, inputs: AddInputs, ctx: Context) -> AddOutputs:
        """``a + b``."""
        return AddOutputs(sum=(inputs.a or 0.0) + (inputs.b or 0.0))


class ConstantParams(Params):
    """``value``: what comes out."""

    value: float = 1.0


class Constant(Module[ConstantParams, Nothing, Value]):
    """The same number at every call: a source, lifted out of every loop."""

    name = "constant"

    def run(self, inputs: Nothing, ctx: Context) -> Value:
        """``params.value``."""
        return Value(value=self.params.value)


class DelayParams(Params):
    """``start``: what comes out while nothing has come in."""

    start: float = 0.0


class Delay(Module[DelayParams, MaybeValue, Value]):
    """What came in, unchanged: with a feedback edge before it, the value of the turn before."""

    name = "delay"

    def run(self, inputs: MaybeValue, ctx: Context) -> Value:
        """The input, or ``params.start`` where there is none."""
        return Value(value=self.params.start if inputs.value is None else inputs.value)


class ThresholdParams(Params):
    """``at``: from where on a value counts as above."""

    at: float = 0.0


class Above(Ports):
    """Whether it is above; for ``until: {holds: node.above}``."""

    above: bool


class Threshold(Module[ThresholdParams, Value, Above]):
    """Whether a number has reached ``at``."""

    name = "threshold"

    def run(self, inputs: Value, ctx: Context) -> Above:
        """``value >= at``."""
        return Above(above=inputs.value >= self.params.at)


class Diverge(Module[Params, Value, Value]):
    """Twice the number: a loop through it never converges."""

    name = "diverge"

    def run(self, inputs: Value, ctx: Context) -> Value:
        """``2 value``."""
        return Value(value=2 * inputs.value)


class ScaleParams(Params):
    """``factor`` and ``offset`` of a straight line; |factor| < 1 converges in a loop."""

    factor: float = 0.5
    offset: float = 0.0


class Scale(Module[ScaleParams, Value, Value]):
    """A straight line: in a loop it converges to offset / (1 − factor)."""

    name = "scale"

    def run(self, inputs: Value, ctx: Context) -> Value:
        """``factor value + offset``."""
        return Value(value=self.params.factor * inputs.value + self.params.offset)


class Counter(Module[Params, MaybeValue, Value]):
    """One more than came in: fed by its own output, it counts the turns; nothing yet counts as 0."""

    name = "counter"

    def run(self, inputs: MaybeValue, ctx: Context) -> Value:
        """``value + 1``."""
        return Value(value=(inputs.value or 0.0) + 1)


class ReactParams(Params):
    """``c``: the size of the market."""

    c: float = 5.0


class React(Module[ReactParams, Value, Value]):
    """The best response (c − x)/2 of a player to the other's move x.

    Two of them in a loop reach the Nash equilibrium (c/3, c/3), the error falling by ¼ a turn.
    """

    name = "react"

    def run(self, inputs: Value, ctx: Context) -> Value:
        """``(c − value) / 2``."""
        return Value(value=(self.params.c - inputs.value) / 2)
