"""The module contract: what a vision module is, declares and may count on.

1. ``run`` is a function of its inputs, its parameters and the context.
2. It never modifies its inputs; they arrive read-only.
3. Its outputs have the declared kind, dtype and dims.
4. What it keeps between turns it returns as an output and gets back by a feedback edge.
5. ``__init__`` is cheap.
6. Every optional input may be None.
7. It opens no file and no socket and has no global state (numba's cache apart).
8. It calls ``ctx.check()`` between long library calls.

Each sentence is a test of :class:`visint.testing.ModuleContract`, to be subclassed for a module of your own.
"""

from __future__ import annotations

import typing
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, Generic, TypeVar, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict

from visint.arrays import Array
from visint.errors import ModuleError
from visint.ports import Ports, PortSpec

__all__ = ["CONTRACT", "Context", "Module", "Params", "PortSpec", "Ports"]

CONTRACT = 1
"""The version of this contract; a plugin may say which one it was written for."""


class Params(BaseModel):
    """Parameters of a module: a frozen pydantic model that refuses unknown names.

    Lengths are in **full-size pixels** (multiply by ``1 / ctx.scale`` at a level), angles in radians.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)


class Context:
    """What the engine tells a module about where it runs, and where the module may speak up.

    Attributes
    ----------
    level
        0 is full size; each level halves both sides.
    scale
        2**level: a length of n full-size pixels is n / scale pixels here.
    size
        (rows, columns) of the images at this level; None in a graph without images.
    """

    __slots__ = ("_cancelled", "_note", "_per_turn", "_seed", "_turns", "level", "size")

    def __init__(  # noqa: PLR0913 - keyword-only facts about a call, built by the engine and by tests
        self,
        *,
        level: int = 0,
        size: tuple[int, int] | None = None,
        turns: tuple[int, ...] = (),
        seed: tuple[int, ...] = (0,),
        per_turn: bool = True,
        note: Callable[[str, str, Any], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
    ) -> None:
        self.level = level
        self.size = size
        self._turns = turns
        self._seed = seed
        self._per_turn = per_turn
        self._note = note
        self._cancelled = cancelled

    @property
    def scale(self) -> int:
        """2**level."""
        return 1 << self.level

    @property
    def turn(self) -> int:
        """The turn of the innermost loop, from 0. Only a module with ``per_turn = True`` may ask."""
        self._needs_per_turn("ctx.turn")
        return self._turns[-1] if self._turns else 0

    @property
    def rng(self) -> np.random.Generator:
        """Random numbers seeded by the run's seed and the node's place in the graph, never by its name.

        New at every call of ``run``: equal runs give equal numbers. Only with ``per_turn = True``.
        """
        self._needs_per_turn("ctx.rng")
        return np.random.default_rng((*self._seed, self.level, *self._turns))

    def _needs_per_turn(self, what: str) -> None:
        if not self._per_turn:
            raise ModuleError.of(
                "VI403",
                f"{what} is for modules that say that their result may change from turn to turn",
                write="per_turn = True",
            )

    def check(self) -> None:
        """Raises :class:`visint.Cancelled` if the run was interrupted; call it between long library calls."""
        if self._cancelled is not None and self._cancelled():
            from visint.errors import Cancelled

            raise Cancelled.of("VI130", "the run was interrupted")

    def measure(self, name: str, value: float) -> None:
        """Records a number about this call: it appears in ``Result.measures`` and in ``run.json``."""
        if self._note is not None:
            self._note("measure", name, float(value))

    def assumed(self, name: str, held: bool | Array, regions: Array | None = None) -> None:
        """Records where a premise of the module (:attr:`Module.assumptions`) held and where it did not.

        What was said last at the finest level counts. A module that abstains may say why by this.

        Parameters
        ----------
        name
            One that the module declares.
        held
            Whether it held in the whole image; or with ``regions`` bool (N,), by label, that of label 0 unused.
        regions
            int32 (H, W), labels from 1 and 0 for pixels that belong to none. Labels from N on count as not
            looked at.

        Raises
        ------
        ValueError
            If ``held`` is not one flag, or with ``regions`` not one flag a label.
        """
        if self._note is None:
            return
        if regions is None:
            self._note("assumed", name, (bool(held), None))
            return
        by_label = np.asarray(held, dtype=bool)
        if by_label.ndim != 1:
            raise ValueError(
                f"{name!r} with regions wants one flag a label, not an array of {by_label.ndim} axes"
            )
        self._note("assumed", name, (by_label, regions))

    def warn(self, code: str, text: str) -> None:
        """Records a warning: ``code`` is a short name in the module's words, ``text`` one sentence."""
        if self._note is not None:
            self._note("warning", code, text)


P = TypeVar("P", bound=Params)
I = TypeVar("I", bound=Ports)  # noqa: E741 - the contract reads Module[P, I, O]
O = TypeVar("O", bound=Ports)  # noqa: E741 - the contract reads Module[P, I, O]


class Module(ABC, Generic[P, I, O]):
    """A vision module: typed parameters, inputs and outputs, and one method.

    A subclass names its three models in brackets, sets :attr:`name` and writes :meth:`run`; its id in graph
    files is ``<entry point>.<name>``. The first line of its docstring says what it recovers.
    """

    name: ClassVar[str] = ""
    """The module's own name, ``[a-z][a-z0-9_]*``."""
    version: ClassVar[str] = "1"
    """Raised when results change; recorded with every run."""
    per_turn: ClassVar[bool] = False
    """True if equal inputs may give another result next turn (it reads ``ctx.rng`` or ``ctx.turn``).

    The engine lifts other nodes out of a loop that feeds them nothing."""

    assumptions: ClassVar[tuple[str, ...]] = ()
    """The premises the module rests on, names of :data:`visint.fields.assumptions.ASSUMPTIONS`.

    A premise missing there is named ``plugin.name``. Where the module tests one it says so by
    :meth:`Context.assumed`."""

    Params: ClassVar[type[Params]]
    Inputs: ClassVar[type[Ports]]
    Outputs: ClassVar[type[Ports]]

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        for base in cls.__dict__.get("__orig_bases__", ()):
            origin = get_origin(base)
            if isinstance(origin, type) and issubclass(origin, Module):
                cls.Params, cls.Inputs, cls.Outputs = _models(origin, get_args(base), cls.__qualname__)

    def __init__(self, params: P | None = None) -> None:
        self.params: P = params if params is not None else typing.cast("P", type(self).Params())

    @abstractmethod
    def run(self, inputs: I, ctx: Context) -> O:
        """What the module recovers from ``inputs``; see the eight sentences above."""


def _models(origin: type[Module[Any, Any, Any]], given: tuple[Any, ...], of: str) -> tuple[Any, Any, Any]:
    """The three models of the class ``of``, whose base is ``origin[given]``; some may still be left open."""
    if origin is not Module:
        filled = dict(zip(origin.__parameters__, given, strict=True))  # type: ignore[attr-defined]
        given = tuple(filled.get(model, model) for model in (origin.Params, origin.Inputs, origin.Outputs))
    for model, wanted in zip(given, (Params, Ports, Ports), strict=True):
        if not isinstance(model, TypeVar) and not (isinstance(model, type) and issubclass(model, wanted)):
            raise TypeError(
                f"{of}: {model!r} is no subclass of {wanted.__name__}; write Module[Params, Inputs, Outputs]"
            )
    return given[0], given[1], given[2]
