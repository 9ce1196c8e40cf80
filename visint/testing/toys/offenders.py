"""Toy modules that do what a module must not: the engine has to notice, and to name them."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from visint.arrays import Array, Image
from visint.module import Context, Module, Params, Ports
from visint.testing.toys.images import ImagePorts
from visint.testing.toys.scalars import MaybeValue, Value

__all__ = ["Fail", "Scribble", "Wrong"]


class FailParams(Params):
    """``message`` of the error, and ``at``: it fails from that value on (None: always)."""

    message: str = "the toy broke"
    at: float | None = None


class Fail(Module[FailParams, MaybeValue, Value]):
    """Raises, at once or when its number has grown to ``at``."""

    name = "fail"

    def run(self, inputs: MaybeValue, ctx: Context) -> Value:
        """The input, if it does not fail.

        Raises
        ------
        RuntimeError
            With ``params.message``.
        """
        value = inputs.value or 0.0
        if self.params.at is None or value >= self.params.at:
            raise RuntimeError(self.params.message)
        return Value(value=value)


class Scribble(Module[Params, ImagePorts, ImagePorts]):
    """Writes into its input. The arrays that arrive are read-only, so this raises."""

    name = "scribble"

    def run(self, inputs: ImagePorts, ctx: Context) -> ImagePorts:
        """Never returns: ValueError."""
        inputs.image[0, 0] = 0.0
        return inputs


class WrongParams(Params):
    """``what`` is wrong with the output; ``checked`` says whether the output's own check is let see it."""

    what: Literal["dtype", "axes", "type", "port", "size"] = "dtype"
    checked: bool = True


class WrongOutputs(Ports):
    """An image, and one of the same size."""

    image: Image[Array, "H W"]
    other: Image[Array, "H W"]


class Wrong(Module[WrongParams, ImagePorts, WrongOutputs]):
    """Returns what it did not declare: another dtype, number of axes, type, or sizes that differ."""

    name = "wrong"

    def run(self, inputs: ImagePorts, ctx: Context) -> WrongOutputs:
        """An output that is wrong in ``params.what``."""
        image = inputs.image
        wrongs: dict[str, dict[str, Any]] = {
            "dtype": {"image": image.astype(np.float64), "other": image},
            "axes": {"image": image[..., None], "other": image},
            "type": {"image": image.tolist(), "other": image},
            "port": {"picture": image, "other": image},
            "size": {"image": image, "other": image[:-1]},
        }
        fill = WrongOutputs.model_validate if self.params.checked else _unchecked
        return fill(wrongs[self.params.what])


def _unchecked(values: dict[str, Any]) -> WrongOutputs:
    return WrongOutputs.model_construct(**values)
