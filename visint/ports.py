"""Ports: what a node takes and gives, declared as annotated fields and held against every value."""

from __future__ import annotations

import types
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Union, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict
from pydantic_core.core_schema import CoreSchema, no_info_after_validator_function

from visint.arrays import ArraySpec
from visint.fields.evidence import Evidence

__all__ = ["PortSpec", "Ports", "always"]


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
        return always

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


def always(values: Mapping[str, Any]) -> None:
    """The check of a class whose ports share no dim."""


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
    dims_agree: ClassVar[Callable[[Mapping[str, Any]], None]] = staticmethod(always)

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        cls.specs = {name: _port(name, _annotation(cls, name)) for name in cls.model_fields}
        cls.dims_agree = staticmethod(_agreement(cls.specs))

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> CoreSchema:
        schema: CoreSchema = handler(source)
        specs = {name: _port(name, _annotation(cls, name)) for name in cls.model_fields}
        if _agreement(specs) is always:  # the check of a single port costs nothing but this look
            return schema
        return no_info_after_validator_function(_agreeing, schema)


def _agreeing(ports: Ports) -> Ports:
    type(ports).dims_agree(ports.__dict__)
    return ports
