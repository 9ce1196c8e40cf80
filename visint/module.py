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

import types
import typing
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, Self, TypeVar, Union, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator

from visint.arrays import ArraySpec
from visint.errors import ModuleError
from visint.fields.evidence import Evidence

__all__ = ["CONTRACT", "Context", "Module", "Params", "PortSpec", "Ports"]

CONTRACT = 1
"""The version of this contract; a plugin may say which one it was written for."""


class Params(BaseModel):
    """Parameters of a module: a frozen pydantic model that refuses unknown names.

    Lengths are in **full-size pixels** (multiply by ``1 / ctx.scale`` at a level), angles in radians.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)


@dataclass(frozen=True, slots=True)
class PortSpec:
    """One port as declared.

    ``kind`` is the field kind's name; ``array`` its spec or None; ``optional`` says that None may arrive,
    ``many`` that it takes a list, ``evidence`` that the value comes with sigma and reliability.
    """

    name: str
    kind: str
    array: ArraySpec | None = None
    optional: bool = False
    many: bool = False
    evidence: bool = False

    def __str__(self) -> str:
        text = str(self.array) if self.array and not self.evidence else self.kind
        text = f"{self.kind} evidence" if self.evidence else text
        return (f"[{text}]" if self.many else text) + "?" * self.optional


class Ports(BaseModel):
    """Inputs or outputs of a module: one annotated field a port.

    A port is an array (``Depth[Array, "H W"]``), evidence (``DepthEvidence``), a ``Camera``, a ``Light``, a
    number, a flag, or a class of your own; ``| None`` makes it optional, ``tuple[..., ...]`` a list. Ports
    that name the same dim must agree in size, lists and evidence included. Arrays come out read-only.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", hide_input_in_errors=True, arbitrary_types_allowed=True
    )
    specs: ClassVar[Mapping[str, PortSpec]] = {}
    """The ports of this class by name, in the order of declaration."""
    dims_agree: ClassVar[Callable[[Mapping[str, Any]], None]]

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        cls.specs = {name: _port(name, _annotation(cls, name)) for name in cls.model_fields}
        cls.dims_agree = staticmethod(_agreement(cls.specs))

    @model_validator(mode="after")
    def _dims_agree(self) -> Self:
        type(self).dims_agree(self.__dict__)
        return self


def _annotation(cls: type[BaseModel], name: str) -> Any:
    info = cls.model_fields[name]
    return Annotated[(info.annotation, *info.metadata)] if info.metadata else info.annotation


def _port(name: str, annotation: Any) -> PortSpec:
    optional = many = False
    if get_origin(annotation) in (Union, types.UnionType):
        inner = [arg for arg in get_args(annotation) if arg is not type(None)]
        optional = len(inner) < len(get_args(annotation))
        if len(inner) != 1:
            raise TypeError(f"port {name!r}: a port has one kind, or one kind and None")
        annotation = inner[0]
    if get_origin(annotation) is tuple:
        args = get_args(annotation)
        if len(args) != 2 or args[1] is not Ellipsis:
            raise TypeError(f"port {name!r}: a list of values is spelled tuple[..., ...]")
        many, annotation = True, args[0]
    kind, array, evidence = _kind(name, annotation)
    return PortSpec(name, kind, array, optional, many, evidence)


_PLAIN = {float: "Scalar", int: "Scalar", bool: "Flag", str: "Text"}
_ANYTHING: tuple[object, ...] = (Any, object, np.ndarray, list, tuple, dict, set)


def _kind(name: str, annotation: Any) -> tuple[str, ArraySpec | None, bool]:
    """(kind, array spec, whether it is evidence) of one port's annotation without None and tuple."""
    if get_origin(annotation) is Annotated:
        for extra in get_args(annotation)[1:]:
            if isinstance(extra, ArraySpec):
                return extra.kind, extra, False
        annotation = get_args(annotation)[0]
    if isinstance(annotation, typing.ForwardRef):
        spelled = annotation.__forward_arg__
        raise TypeError(f"port {name!r}: {spelled!r} is not known at run time; import it outside TYPE_CHECKING")
    if not isinstance(annotation, type) or annotation in _ANYTHING:
        raise TypeError(f'port {name!r}: {annotation} is no port type; write for instance Depth[Array, "H W"]')
    if issubclass(annotation, Evidence):
        _, array, _ = _kind(name, _annotation(annotation, "value"))
        return annotation.measures, array, True
    kind = _PLAIN.get(annotation) or getattr(annotation, "__kind__", None)
    return kind or f"{annotation.__module__}.{annotation.__qualname__}", None, False


def _agreement(specs: Mapping[str, PortSpec]) -> Callable[[Mapping[str, Any]], None]:
    """A check, made once a class, that ports naming the same dim agree; free where no dim is shared."""
    plan = [
        (
            spec.name,
            spec.many,
            spec.evidence,
            tuple((i, d) for i, d in enumerate(spec.array.dims) if isinstance(d, str)),
        )
        for spec in specs.values()
        if spec.array is not None
    ]
    named = [dim for _, many, _, dims in plan for _, dim in dims * (1 + many)]
    if len(named) == len(set(named)):
        return _always

    def agree(values: Mapping[str, Any]) -> None:
        sizes: dict[str, tuple[int, str]] = {}
        for name, many, evidence, dims in plan:
            value = values[name]
            if value is None:
                continue
            for one in value if many else (value,):
                shape = one.value.shape if evidence else one.shape
                for axis, dim in dims:
                    size, first = sizes.setdefault(dim, (shape[axis], name))
                    if size != shape[axis]:
                        raise ValueError(
                            f"{dim} is {size} on port {first!r} but {shape[axis]} on port {name!r}"
                        )

    return agree


def _always(values: Mapping[str, Any]) -> None:
    pass


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

    def warn(self, code: str, text: str) -> None:
        """Records a warning: ``code`` is a short name in the module's words, ``text`` one sentence."""
        if self._note is not None:
            self._note("warning", code, text)


P = TypeVar("P", bound=Params)
I = TypeVar("I", bound=Ports)  # noqa: E741 - the contract reads Module[P, I, O]
O = TypeVar("O", bound=Ports)  # noqa: E741


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
