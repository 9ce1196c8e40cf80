"""Modules that break one sentence of the contract each; `test_kit` holds that exactly that one is noticed."""

from __future__ import annotations

import contextlib
import os
import random
import socket
import tempfile
import time
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from visint.arrays import Array, Boundaries, Depth, Image
from visint.fields import DepthEvidence
from visint.module import Context, Module, Params, Ports


class In(Ports):
    image: Image[Array, "H W"]
    depth: Depth[Array, "H W"] | None = None
    boundaries: Boundaries[Array, "H W"] | None = None


class Out(Ports):
    image: Image[Array, "H W"]


class Good(Module[Params, In, Out]):
    """Keeps every sentence; the offenders below differ from it in one thing each."""

    name = "good"
    breaks: ClassVar[set[str]] = set()

    def run(self, inputs: In, ctx: Context) -> Out:
        ctx.check()
        return Out(image=self.made(inputs, ctx))

    def made(self, inputs: In, ctx: Context) -> Any:
        return inputs.image * 2


class Dice(Good):
    """Uses random numbers of its own."""

    breaks: ClassVar = {"test_1_run_is_a_function", "test_4_nothing_is_kept_between_turns"}

    def made(self, inputs, ctx):
        return (inputs.image + np.random.default_rng().random()).astype(np.float32)


class Individual(Good):
    """Each instance is a little different."""

    breaks: ClassVar = {"test_1_run_is_a_function"}
    born = 0

    def __init__(self, params: Params | None = None) -> None:
        super().__init__(params)
        Individual.born += 1
        self.offset = Individual.born

    def made(self, inputs, ctx):
        return inputs.image + np.float32(self.offset)


class Undeclared(Good):
    """Speaks of an assumption that it does not declare."""

    breaks: ClassVar = {"test_assumptions_are_declared"}

    def made(self, inputs, ctx):
        ctx.assumed("opacity", True)
        return inputs.image * 2


class Misspelled(Good):
    """Declares an assumption that nobody knows."""

    breaks: ClassVar = {"test_assumptions_are_declared"}
    assumptions = ("opaqueness",)


class HalfSaid(Good):
    """Leaves out the flag of the second region."""

    breaks: ClassVar = {"test_assumptions_are_declared"}
    assumptions = ("homogeneity",)

    def made(self, inputs, ctx):
        ctx.assumed("homogeneity", [False, True], np.full(inputs.image.shape, 2, np.int32))
        return inputs.image * 2


class Turning(Good):
    """Asks for the turn without saying `per_turn`: nothing else of it can run."""

    breaks: ClassVar = {"*"}

    def made(self, inputs, ctx):
        return inputs.image + np.float32(ctx.turn)


class Scribbler(Good):
    """Unlocks its input and writes into it: the second call sees other inputs."""

    breaks: ClassVar = {"test_2_inputs_are_left_alone"}

    def made(self, inputs, ctx):
        base = inputs.image.base if inputs.image.base is not None else inputs.image.copy()
        base[0, 0] = 0
        return inputs.image * 2


class Doubles(Good):
    """Returns float64 past the output's own check."""

    breaks: ClassVar = {
        "test_3_outputs_are_as_declared",
        "test_6_optional_inputs_may_be_none",
        *("test_any_size", "test_no_texture", "test_unknown_pixels"),
    }

    def run(self, inputs, ctx):
        ctx.check()
        return Out.model_construct(image=inputs.image.astype(np.float64))


class Shrinks(Good):
    """Returns half the rows and still calls them H."""

    breaks: ClassVar = {
        "test_3_outputs_are_as_declared",
        "test_6_optional_inputs_may_be_none",
        *("test_any_size", "test_no_texture", "test_unknown_pixels"),
    }

    def made(self, inputs, ctx):
        return inputs.image[::2]


class Hoarder(Good):
    """Mixes in what it saw the turn before."""

    breaks: ClassVar = {"test_1_run_is_a_function", "test_4_nothing_is_kept_between_turns"}

    def made(self, inputs, ctx):
        before = getattr(self, "before", inputs.image)
        self.before = inputs.image
        return inputs.image + before if before.shape == inputs.image.shape else inputs.image


class Reuser(Good):
    """Hands out one buffer again and again."""

    breaks: ClassVar = {"test_4_nothing_is_kept_between_turns"}

    def made(self, inputs, ctx):
        if getattr(self, "buffer", None) is None or self.buffer.shape != inputs.image.shape:
            self.buffer = np.empty_like(inputs.image)
        self.buffer[:] = inputs.image
        return self.buffer


class SlowStart(Good):
    """Takes its time to be made."""

    breaks: ClassVar = {"test_5_init_is_cheap"}

    def __init__(self, params: Params | None = None) -> None:
        super().__init__(params)
        time.sleep(0.012)


class EagerImport(Good):
    """Imports scipy to be made."""

    breaks: ClassVar = {"test_5_init_is_cheap"}

    def __init__(self, params: Params | None = None) -> None:
        super().__init__(params)
        import scipy  # noqa: F401


class Demanding(Good):
    """Needs an optional input."""

    breaks: ClassVar = {"test_6_optional_inputs_may_be_none"}

    def made(self, inputs, ctx):
        return np.where(inputs.boundaries.any(), inputs.image, 0).astype(np.float32)


class Writer(Good):
    """Leaves a file behind."""

    breaks: ClassVar = {"test_7_it_leaves_the_world_alone"}

    def made(self, inputs, ctx):
        file = Path(tempfile.gettempdir(), "visint-offence.txt")
        file.write_text("here", encoding="utf-8")
        file.unlink()
        return inputs.image


class Reader(Good):
    """Reads a file of its own at every call."""

    breaks: ClassVar = {"test_7_it_leaves_the_world_alone"}

    def made(self, inputs, ctx):
        with open(os.devnull, "rb") as file:  # noqa: PTH123 - the plainest offence
            file.read()
        return inputs.image


class Talker(Good):
    """Opens a socket."""

    breaks: ClassVar = {"test_7_it_leaves_the_world_alone"}

    def made(self, inputs, ctx):
        socket.socket().close()
        return inputs.image


class Seeder(Good):
    """Seeds everybody's random numbers."""

    breaks: ClassVar = {"test_7_it_leaves_the_world_alone"}

    def made(self, inputs, ctx):
        np.random.seed(int.from_bytes(os.urandom(3)))
        return inputs.image


class Shuffler(Good):
    """Draws from Python's random numbers."""

    breaks: ClassVar = {"test_7_it_leaves_the_world_alone"}

    def made(self, inputs, ctx):
        random.random()
        return inputs.image


class Deaf(Good):
    """Cannot be interrupted."""

    breaks: ClassVar = {"test_8_it_can_be_interrupted"}

    def run(self, inputs, ctx):
        return Out(image=inputs.image)


class Stubborn(Good):
    """Swallows the interruption."""

    breaks: ClassVar = {"test_8_it_can_be_interrupted"}

    def run(self, inputs, ctx):
        with contextlib.suppress(Exception):
            ctx.check()
        return Out(image=inputs.image)


class Big(Good):
    """Takes differences without asking whether there is a neighbour."""

    breaks: ClassVar = {"test_any_size"}

    def made(self, inputs, ctx):
        return np.gradient(inputs.image)[0].astype(np.float32)


class Divider(Good):
    """Stretches the contrast: 0/0 where there is none."""

    breaks: ClassVar = {"test_no_texture", "test_any_size"}

    def made(self, inputs, ctx):
        image = inputs.image
        return (image - image.min()) / (image.max() - image.min())


class Averager(Good):
    """Takes the mean of the known depths: of nothing, where nothing is known."""

    breaks: ClassVar = {"test_unknown_pixels"}

    def made(self, inputs, ctx):
        if inputs.depth is None:
            return inputs.image
        return inputs.image + np.float32(np.nanmean(inputs.depth))


class Liar(Good):
    """Says another name than graph files can spell."""

    name = "Not a name"
    breaks: ClassVar = {"test_0_it_declares_itself"}


class EvidenceOut(Ports):
    evidence: DepthEvidence


class Inconsistent(Module[Params, In, EvidenceOut]):
    """Evidence that speaks and is unknown at once, past its own check."""

    name = "inconsistent"
    breaks: ClassVar = Doubles.breaks

    def run(self, inputs: In, ctx: Context) -> EvidenceOut:
        ctx.check()
        ones = np.ones(inputs.image.shape, np.float32)
        wrong = DepthEvidence.model_construct(value=ones * np.nan, sigma=ones, reliability=ones)
        return EvidenceOut.model_construct(evidence=wrong)


OFFENDERS = [
    each
    for each in list(globals().values())
    if isinstance(each, type) and issubclass(each, Module) and "breaks" in vars(each)
]
